// The list of jobs: one page of it, filtered by the address, kept up to date by the stream of all jobs' events.

import * as api from "../common/api.js";
import { describeJob } from "../common/describe.js";
import { byId, el, notify, show } from "../common/dom.js";
import { followJobs } from "../common/follow.js";
import * as address from "./address.js";
import { Row } from "./rows.js";
import { Selection } from "./selection.js";
import { count, nameOf } from "./words.js";

const LABELS_FROM = 200;
const TICK_MS = 1000;
const TYPING_MS = 300;
/** Time in which further changes are waited for before the page is read again. */
const SETTLING_MS = 400;

const body = byId("jobs").tBodies[0];
const notice = byId("notice");
/** @type {Map<string, Row>} */
const rows = new Map();
/** Ids of deleted jobs: later messages about them are ignored. */
const deletedIds = new Set();
/** Jobs with an event since the list was requested. @type {Map<string, Job>} */
let changed = new Map();
const labels = new Set();
let view = address.read();
/** @type {string | null} */
let nextCursor = null;
/** Number of jobs in the list as filtered; null before the first answer. @type {number | null} */
let total = null;
/** @type {number | undefined} */
let settling;
let newer = new Set();
/** The request under way. @type {AbortController | null} */
let request = null;
/** Whether the list changed after the request in progress was sent. */
let isOutdated = false;
/** Whether the rows are those of this view. */
let isFilled = false;
let stopFollowing = () => {};

const shown = () => [...body.rows].flatMap((node) => rows.get(node.dataset.id ?? "") ?? []);
const selection = new Selection({ rows: shown, changed: onJob, removed: remove, failed });

/** @param {any[]} errors */
function failed(errors) {
  if (errors.length === 0) return notify(notice, null);
  const [first] = errors;
  const problem = first.problem ?? { title: String(first.message ?? first) };
  notify(notice, { problem: { ...problem, title: errors.length > 1 ? `${count(errors.length)} could not be changed. ${problem.title}` : problem.title } });
}

/** Reads this page of the list; one question at a time. */
async function refresh() {
  isOutdated = request !== null;
  if (isOutdated) return;
  request = new AbortController();
  const { signal } = request;
  changed = new Map();
  const { cursor } = view;
  try {
    const page = await api.jobs(address.parameters(view), signal);
    if (signal.aborted) return;
    notify(notice, null);
    nextCursor = page.next_cursor ?? null;
    total = page.total;
    fill(page.items.filter((job) => !deletedIds.has(job.id)));
    isFilled = true;
    if (cursor === "") newer = new Set();
    for (const job of changed.values()) onJob(job);
  } catch (error) {
    if (signal.aborted) return;
    // A cursor that came with a shared address may belong to other filters: the first page is shown then.
    if (error instanceof api.Problem && error.problem.code === "invalid-cursor") return navigate({ ...view, cursor: "", trail: [] }, false);
    notify(notice, error);
  }
  request = null;
  updatePage();
  if (isOutdated) await refresh();
}

/**
 * Puts the rows in order: those that stay keep their places in the document, and with them the focus.
 * @param {Job[]} jobs
 */
function fill(jobs) {
  const wanted = new Set(jobs.map((job) => job.id));
  for (const id of [...rows.keys()].filter((id) => !wanted.has(id))) drop(id);
  let at = body.firstElementChild;
  for (const job of jobs) {
    const row = rowOf(job);
    if (at && row.node === at) at = at.nextElementSibling;
    else body.insertBefore(row.node, at);
  }
}

/** The row of a job, updated. @param {Job} job */
function rowOf(job) {
  const present = rows.get(job.id);
  if (present) {
    if (present.update(job)) announce(present.job);
    selection.know(present.job);
    return present;
  }
  const row = new Row(job, {
    select: (picked, isRange) => selection.pick(picked, isRange),
    filter: (label) => navigate({ ...view, label, cursor: "", trail: [] }, true),
    describe: (asked, opener) => describe(asked, opener),
    cancel: (asked) => selection.each([asked], (job) => selection.stop(job)),
    remove: (asked) => selection.remove([asked]),
  });
  rows.set(job.id, row);
  selection.know(job);
  if (job.label) labels.add(job.label);
  return row;
}

/** Removes a row. @param {string} id */
function drop(id) {
  const row = rows.get(id);
  if (!row) return;
  const next = /** @type {HTMLElement | null} */ (row.node.nextElementSibling ?? row.node.previousElementSibling);
  const hadFocus = row.hasFocus;
  row.node.remove();
  rows.delete(id);
  if (hadFocus) (rows.get(next?.dataset.id ?? "")?.link ?? byId("select-all")).focus();
}

/** Takes up a job that has changed or is new. Ids sort by the time of submission. @param {Job} job */
function onJob(job) {
  if (deletedIds.has(job.id)) return;
  changed.set(job.id, job);
  selection.know(job);
  // Its place is known once the list is: its row is added then.
  if (!isFilled) return;
  const row = rows.get(job.id);
  const fits = address.fits(job, view);
  if (row) {
    rowOf(job);
    row.node.classList.toggle("past", !fits);
    if (!fits && !row.hasFocus && !row.box.checked) {
      drop(job.id);
      readAgain();
    } else if (row.hasMoved(view.sort)) {
      readAgain();
    }
  } else if (fits) {
    add(job);
  }
  updatePage();
}

/** Reads this page again once the changes have settled: its places, and the number of jobs, follow from the list. */
function readAgain() {
  clearTimeout(settling);
  settling = setTimeout(refresh, SETTLING_MS);
}

const isNewestFirst = () => view.sort === address.NEWEST;

/** Adds the row of a new job. @param {Job} job */
function add(job) {
  const present = shown();
  const isFirst = view.cursor === "";
  if (!isNewestFirst()) {
    readAgain();
    return;
  }
  if (!isFirst && (present.length === 0 || job.id > present[0].job.id)) {
    // Jobs on the pages before this one change, too: only a job that was just submitted is new.
    const endedAtOnce = job.ended_at === job.submitted_at;
    if (endedAtOnce || (job.state === "queued" && job.attempt === 0)) newer.add(job.id);
    return;
  }
  // It belongs to a later page.
  if (nextCursor !== null && present.length > 0 && job.id < present[present.length - 1].job.id) return;
  const after = present.find((row) => row.job.id < job.id);
  body.insertBefore(rowOf(job).node, after?.node ?? null);
  if (isFirst && job.id > (present[0]?.job.id ?? "")) announceText(`New job: ${nameOf(job)}`);
  readAgain();
}

/**
 * Opens the window in which name, label and notes of a job are changed.
 * @param {Job} job
 * @param {HTMLElement} opener
 */
async function describe(job, opener) {
  const described = await describeJob(job);
  if (described) onJob(described);
  opener.focus();
}

/** Takes up that a job was deleted. @param {string} id */
function remove(id) {
  deletedIds.add(id);
  newer.delete(id);
  selection.forget(id);
  drop(id);
  updatePage();
  readAgain();
}

/** Brings the rest of the page in line with the rows. */
function updatePage() {
  const empty = isFilled && rows.size === 0;
  show(byId("empty"), empty);
  show(byId("jobs"), !empty);
  if (empty) byId("empty").replaceChildren(...emptyTexts());
  if (isFilled) byId("jobs").setAttribute("aria-busy", "false");
  byId("older").disabled = nextCursor === null;
  byId("newer").disabled = view.cursor === "";
  if (total !== null) byId("place").textContent = placeText(total);
  showOrder();
  const button = byId("new-jobs");
  show(button, newer.size > 0);
  button.textContent = `${count(newer.size, "new job")}: to the newest`;
  const filtered = address.isFiltered(view);
  byId("clear-filters").disabled = !filtered;
  selection.show();
}

/** The place of the page in the list. @param {number} all */
function placeText(all) {
  const jobs = `${count(all)}${address.isFiltered(view) ? " fit the filters" : ""}`;
  const before = view.cursor === "" ? 0 : view.trail ? view.trail.length * view.limit : null;
  if (rows.size === 0 || before === null) return jobs;
  return all <= rows.size ? jobs : `${before + 1} to ${before + Math.min(rows.size, view.limit)} of ${jobs}`;
}

/** Shows in the heads of the columns what the list is sorted by. */
function showOrder() {
  const [by, order] = view.sort.split("-");
  for (const head of sortedHeads()) {
    if (head.dataset.sort === by) head.setAttribute("aria-sort", order === "asc" ? "ascending" : "descending");
    else head.removeAttribute("aria-sort");
  }
  byId("newer").textContent = isNewestFirst() ? "Newer" : "Previous";
  byId("older").textContent = isNewestFirst() ? "Older" : "Next";
}

const sortedHeads = () => /** @type {NodeListOf<HTMLElement>} */ (byId("jobs").querySelectorAll("th[data-sort]"));

/** Sorts by the column of a head: a second click turns the order round. @param {HTMLElement} head */
function sortBy(head) {
  const name = head.dataset.sort ?? "";
  const [first, second] = name === "name" || name === "label" ? ["asc", "desc"] : ["desc", "asc"];
  const sort = view.sort === `${name}-${first}` ? `${name}-${second}` : `${name}-${first}`;
  navigate({ ...view, sort, cursor: "", trail: [] }, true);
}

function emptyTexts() {
  if (view.cursor !== "") return [el("strong", {}, "No older jobs."), " They may have been deleted meanwhile."];
  if (!address.isFiltered(view)) return [el("strong", {}, "No jobs yet."), " ", el("a", { href: "/" }, "Describe a gear pair"), " and submit it: it appears here, and its result stays until it is deleted."];
  const clear = el("button", { type: "button", class: "quiet" }, "Clear filters");
  clear.addEventListener("click", () => byId("filters").reset());
  return [el("strong", {}, "No job fits these filters."), " Jobs that come to fit appear here. ", clear];
}

/** Jobs that ended, for screen readers: collected, so that a batch is one sentence. @type {Job[]} */
const ends = [];
/** @type {number | null} */
let saying = null;

/** @param {Job} job */
function announce(job) {
  ends.push(job);
  saying ??= setTimeout(() => {
    const [only] = ends;
    announceText(ends.length === 1 ? `${nameOf(only)} ${only.state}` : `${ends.length} jobs ended`);
    ends.length = 0;
    saying = null;
  }, 1000);
}

/** @param {string} text */
function announceText(text) {
  byId("announcement").textContent = text;
}

const MODES = { live: "Live", polling: "Asked every 2 s", lost: "Connection lost, trying again …" };

function follow() {
  stopFollowing();
  stopFollowing = followJobs(view, {
    onReload: refresh,
    onJob,
    onDeleted: remove,
    onMode: (mode) => {
      const node = byId("mode");
      node.dataset.mode = mode;
      if (node.textContent !== MODES[mode]) node.textContent = MODES[mode];
    },
  });
}

/**
 * Shows another view of the list, as an entry of its own in the history or in place of the present one.
 * @param {ListView} next
 * @param {boolean} isStep
 */
function navigate(next, isStep) {
  address.write(next, isStep);
  showView(next);
}

/** @param {ListView} next */
function showView(next) {
  const other = next.kind !== view.kind || next.label !== view.label;
  view = next;
  request?.abort();
  request = null;
  clearTimeout(settling);
  isFilled = false;
  newer = new Set();
  address.fillForm(view);
  if (other) follow();
  refresh();
}

const filters = byId("filters");
/** @type {number | undefined} */
let typing;
filters.addEventListener("input", (event) => {
  clearTimeout(typing);
  // All letters typed without a pause are one step.
  if (address.isTyped(event.target)) typing = setTimeout(() => navigate(address.readForm(), false), TYPING_MS);
});
function applyForm() {
  clearTimeout(typing);
  navigate(address.readForm(), true);
}
filters.addEventListener("change", applyForm);
// Belongs to the form, but stands below the list.
byId("page-size").addEventListener("change", applyForm);
filters.addEventListener("reset", (event) => {
  event.preventDefault();
  navigate(address.withoutFilters(view), true);
});
filters.addEventListener("submit", (event) => event.preventDefault());

/** Labels to choose from: of the jobs seen, and of the newest ones. */
address.label.addEventListener("focus", async () => {
  try {
    for (const { label } of (await api.jobs({ limit: LABELS_FROM })).items) if (label) labels.add(label);
  } catch {
    // Suggestions are a help, no need.
  }
  byId("labels").replaceChildren(...[...labels].sort().map((value) => el("option", { value })));
}, { once: true });

byId("older").addEventListener("click", () => {
  navigate({ ...view, cursor: nextCursor ?? "", trail: [...(view.trail ?? []), view.cursor] }, true);
  top();
});
byId("newer").addEventListener("click", () => {
  const trail = view.trail ?? [];
  navigate({ ...view, cursor: trail.at(-1) ?? "", trail: trail.slice(0, -1) }, true);
  top();
});
byId("new-jobs").addEventListener("click", () => {
  navigate({ ...view, cursor: "", trail: [] }, true);
  top();
});

function top() {
  byId("main").scrollIntoView({ block: "start" });
}

for (const head of sortedHeads()) head.querySelector("button")?.addEventListener("click", () => sortBy(head));
window.addEventListener("popstate", () => showView(address.read()));
setInterval(() => {
  if (document.hidden) return;
  const now = Date.now();
  for (const row of rows.values()) row.tick(now);
}, TICK_MS);

address.fillForm(view);
follow();
refresh();
