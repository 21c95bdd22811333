// The list of jobs. One request refreshes the whole page of it, often while something on it is live: a stream per job
// would soon use up the few connections that a browser opens to one host.

import * as api from "../common/api.js";
import { byId, el, notify, show } from "../common/dom.js";
import { age, instant } from "../common/format.js";
import { describeState, stateBadge } from "../common/state.js";

const LIMIT = 20;
const LIVE_MS = 1000;
const QUIET_MS = 5000;

const filters = byId("filters");
const body = byId("jobs").tBodies[0];
let cursor = null;
let nextCursor = null;
let timer = null;
let asking = null;

async function refresh() {
  clearTimeout(timer);
  asking?.abort();
  asking = new AbortController();
  const { signal } = asking;
  let live = false;
  try {
    const parameters = { limit: LIMIT, cursor, ...Object.fromEntries(new FormData(filters)) };
    const page = await api.jobs(parameters, signal);
    notify(byId("notice"), null);
    nextCursor = page.next_cursor ?? null;
    fill(page.items);
    live = page.items.some((job) => !api.isEnded(job));
  } catch (error) {
    if (signal.aborted) return;
    notify(byId("notice"), error);
  }
  byId("older").disabled = nextCursor === null;
  byId("newest").disabled = cursor === null;
  timer = setTimeout(() => (document.hidden ? later() : refresh()), live ? LIVE_MS : QUIET_MS);
}

/** Nobody looks: wait until somebody does. */
function later() {
  document.addEventListener("visibilitychange", refresh, { once: true });
}

function fill(jobs) {
  show(byId("empty"), jobs.length === 0);
  show(byId("jobs"), jobs.length > 0);
  const focused = document.activeElement?.dataset?.action;
  body.replaceChildren(...jobs.map(row));
  if (focused) body.querySelector(`[data-action="${CSS.escape(focused)}"]`)?.focus();
}

function row(job) {
  const link = el("a", { href: `/jobs/${encodeURIComponent(job.id)}` }, job.name ?? job.id);
  return el(
    "tr",
    { "data-id": job.id },
    el("th", { scope: "row" }, link, job.label ? el("span", { class: "label" }, job.label) : null),
    el("td", {}, job.kind),
    el("td", {}, stateBadge(job), " ", describeState(job), progressBar(job)),
    el("td", { title: instant(job.submitted_at) }, age(job.submitted_at)),
    el("td", { class: "actions" }, api.isEnded(job) ? action(job, "Delete", api.remove) : action(job, "Cancel", api.cancel)),
  );
}

function progressBar(job) {
  if (job.state !== "running") return null;
  return el("progress", { max: 1, value: job.progress ?? 0, "aria-label": "Progress" });
}

function action(job, text, run) {
  const button = el("button", { type: "button", class: "quiet", "aria-label": `${text} ${job.name ?? job.id}`, "data-action": `${text} ${job.id}` }, text);
  if (text === "Cancel" && job.cancel_requested_at) button.disabled = true;
  button.addEventListener("click", async () => {
    button.disabled = true;
    try {
      await run(job.id);
    } catch (error) {
      notify(byId("notice"), error);
    }
    refresh();
  });
  return button;
}

filters.addEventListener("input", () => {
  cursor = null;
  refresh();
});
filters.addEventListener("submit", (event) => event.preventDefault());
byId("older").addEventListener("click", () => {
  cursor = nextCursor;
  refresh();
});
byId("newest").addEventListener("click", () => {
  cursor = null;
  refresh();
});
refresh();
