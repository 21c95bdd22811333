// The page of one job: follows it while it is live and shows its result when it has succeeded.

import * as api from "../common/api.js";
import { byId, el, fillValues, fillWarnings, notify, show } from "../common/dom.js";
import { instant, number, seconds } from "../common/format.js";
import { describeState } from "../common/state.js";
import { watchJob } from "../common/watch.js";
import { showHeadline } from "./headline.js";
import { showGeometry, showImpact, showNumerics } from "./tables.js";
import { showMesh } from "./mesh.js";
import { showResponse } from "./response.js";
import { showSeries } from "./series.js";
import { showSweep } from "../sweep/panel.js";

const { id } = byId("job").dataset;
const notice = byId("notice");
let shown = false;
let revision = -1;

function showLife(job) {
  const title = job.name ?? `Job ${job.id}`;
  byId("title").textContent = title;
  document.title = `${title} · herringbone`;
  show(byId("life"));
  const badge = byId("state");
  if (badge.textContent !== job.state) badge.textContent = job.state;
  badge.className = `badge ${job.state}`;
  byId("stage").textContent = describeState(job);
  const progress = byId("progress");
  show(progress, !api.isEnded(job));
  if (job.state === "queued") progress.removeAttribute("value");
  else progress.value = job.progress ?? 0;
  show(byId("cancel"), !api.isEnded(job));
  byId("cancel").disabled = Boolean(job.cancel_requested_at);
  byId("download-input").href = api.inputUrl(id);
  byId("download-result").href = api.resultUrl(id);
  const solved = job.started_at && job.ended_at ? seconds(job.started_at, job.ended_at) : null;
  fillValues(byId("life-values"), [
    ["Kind", job.kind],
    ["Label", job.label],
    ["Submitted", instant(job.submitted_at)],
    ["Ended", job.ended_at ? instant(job.ended_at) : null],
    ["Attempt", job.attempt > 1 ? String(job.attempt) : null],
    ["Result taken from", job.reused_from ? el("a", { href: `/jobs/${encodeURIComponent(job.reused_from)}` }, "an equal job") : null],
    ["Solved in", solved === null ? null : number(solved, 3), "s"],
  ]);
}

function follow(job) {
  // Events and answers may overtake each other; what is older than what is shown does not count.
  if (job.revision < revision) return;
  revision = job.revision;
  showLife(job);
  if (job.state === "failed") notify(notice, { problem: { title: "The job failed", ...(job.error ?? {}) } });
  if (job.kind === "sweep") {
    show(byId("download-result"), job.state === "succeeded");
    showSweepOf(job).catch((error) => notify(notice, error));
  } else if (job.state === "succeeded" && !shown) {
    shown = true;
    showResult(job).catch((error) => notify(notice, error));
  }
}

/** What a sweep shows is its own affair: its result may be large, and it can be watched while it grows. */
async function showSweepOf(job) {
  await showSweep({ id, job });
  if (job.state === "succeeded") byId("job").dataset.ready = "true";
}

async function showResult(job) {
  show(byId("download-result"));
  const result = await api.result(id);
  fillWarnings(byId("warnings"), result.warnings);
  showHeadline(result);
  showGeometry(result);
  showImpact(result);
  showNumerics(result);
  const catalogue = result.response ? (await api.catalogue(id)).items : [];
  showResponse(result, catalogue);
  await Promise.all([showMesh(result), catalogue.length ? showSeries(id, job, result, catalogue) : null]);
  byId("job").dataset.ready = "true";
}

byId("cancel").addEventListener("click", async () => {
  byId("cancel").disabled = true;
  try {
    follow(await api.cancel(id));
  } catch (error) {
    notify(notice, error);
  }
});

try {
  const job = await api.job(id);
  follow(job);
  if (!api.isEnded(job)) watchJob(id, follow);
} catch (error) {
  notify(notice, error);
}
