// Two to five jobs side by side: inputs that differ, headline numbers, curves.

import * as api from "../common/api.js";
import { byId, notify, show } from "../common/dom.js";
import { followJobs } from "../common/follow.js";
import { nameOf } from "../jobs/words.js";
import * as address from "./address.js";
import { showChosen } from "./chosen.js";
import { LETTERS, entriesOf } from "./entries.js";
import { describeCurves, showCurves, watchOptions } from "./figures.js";
import { load } from "./load.js";
import { pick } from "./picker.js";
import { showSweeps, watchQuantity } from "./sweeps.js";
import { saveTables, showTables } from "./tables.js";

const notice = byId("notice");
let view = address.read();
/** @type {Map<string, import("./load.js").LoadedJob>} */
let known = new Map();
/** Line of each job: kept as long as the job is here. @type {Map<string, number>} */
let slots = new Map();
let turn = 0;
/** @type {(() => void) | null} */
let stopFollowing = null;

/** @param {unknown} error */
function failed(error) {
  notice.classList.add("bad");
  notify(notice, error);
}

/** @param {string} id */
function slotOf(id) {
  const slot = slots.get(id) ?? [...LETTERS].findIndex((_, slot) => ![...slots.values()].includes(slot));
  slots.set(id, slot);
  return slot;
}

/** The jobs in their order, with their names and lines. */
function entries() {
  slots = new Map([...slots].filter(([id]) => view.ids.includes(id)));
  return entriesOf(view.ids, known, slotOf);
}

/** Reads the jobs that are not read yet, and shows all. */
async function refresh() {
  const mine = ++turn;
  try {
    const found = await Promise.all(view.ids.map((id) => load(id, known.get(id))));
    if (mine !== turn) return;
    known = new Map(found.map((entry) => [entry.id, entry]));
    notice.classList.toggle("bad", view.surplus === 0);
    notify(notice, view.surplus > 0 ? { problem: { title: "At most five jobs can be compared.", detail: `The first five are shown; ${view.surplus} more stood in the address.` } } : null);
    await render();
  } catch (error) {
    if (mine === turn) failed(error);
  }
  follow();
}

async function render() {
  const jobs = entries();
  const reference = jobs.find(({ id }) => id === view.reference) ?? jobs[0];
  showChosen(jobs, reference, { add, replace, remove, refer });
  const names = jobs.map(({ name }) => name).join(", ");
  byId("compare").dataset.subject = names;
  byId("report-link").href = `/compare/report${window.location.search}`;
  show(byId("report-link"), jobs.some(({ result, sweep }) => result || sweep));
  document.title = `${names ? `Compare ${names}` : "Compare"} · herringbone`;
  showTables(jobs, reference);
  await Promise.all([showCurves(jobs), showSweeps(jobs, reference)]);
  byId("curves-note").textContent = describeCurves();
  byId("compare").dataset.ready = view.ids.join(",");
}

/** Follows the jobs while one of them is live; the number of streams is limited, so none is kept open without need. */
function follow() {
  const isLive = [...known.values()].some(({ job }) => job && !api.isEnded(job));
  if (isLive && !stopFollowing) {
    stopFollowing = followJobs({}, {
      onReload: () => (turn > 0 ? refresh() : undefined),
      onJob: (job) => known.has(job.id) && take(job),
      onDeleted: (id) => known.has(id) && refresh(),
    });
  } else if (!isLive && stopFollowing) {
    stopFollowing();
    stopFollowing = null;
  }
}

/** Takes up a new state of a job. @param {Job} job */
function take(job) {
  const entry = known.get(job.id);
  if (!entry?.job || entry.job.revision >= job.revision) return;
  if (api.isEnded(job)) {
    byId("said").textContent = `${nameOf(job)} ${job.state}`;
    refresh();
    return;
  }
  known.set(job.id, { ...entry, job });
  const jobs = entries();
  showChosen(jobs, jobs.find(({ id }) => id === view.reference) ?? jobs[0], { add, replace, remove, refer });
}

/** Compares other jobs. @param {{ ids: string[], reference: string }} next */
function go(next) {
  view = { surplus: 0, ...next };
  if (!view.ids.includes(view.reference)) view.reference = address.oldest(view.ids);
  address.write(view, true);
  refresh();
}

const add = () => pick("Add a job", view.ids, (id) => go({ ...view, ids: [...view.ids, id] }), failed);

/** @param {string} old */
function replace(old) {
  pick("Replace the job by", view.ids, (id) => {
    slots.set(id, slotOf(old));
    slots.delete(old);
    go({ ids: view.ids.map((one) => (one === old ? id : one)), reference: view.reference === old ? id : view.reference });
  }, failed);
}

/** @param {string} gone */
const remove = (gone) => go({ ...view, ids: view.ids.filter((id) => id !== gone) });

/** @param {string} reference */
function refer(reference) {
  view = { ...view, reference };
  address.write(view, true);
  render().catch(failed);
}

byId("csv").addEventListener("click", () => {
  const jobs = entries();
  saveTables(jobs, jobs.find(({ id }) => id === view.reference) ?? jobs[0]);
});
window.addEventListener("popstate", () => {
  view = address.read();
  refresh();
});
watchOptions(failed);
watchQuantity(failed);
refresh();
