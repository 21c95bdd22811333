// The state of a job: its stages, its failure, and its actions.

import * as api from "../common/api.js";
import { describeJob } from "../common/describe.js";
import { byAnyId, byId, el, fillValues, notify, show } from "../common/dom.js";
import { instant, number, percent, seconds, sentence } from "../common/format.js";
import { placeOf, readable } from "../common/sentence.js";
import { Bell } from "./bell.js";
import { Remaining, leftText } from "./remaining.js";

const STAGES = { geometry: "Geometry", mesh: "Tooth contact", impact: "Mesh-in impact", response: "Vibration" };
const STAGES_OF = { mesh: ["geometry", "mesh", "impact"], response: ["geometry", "mesh", "impact", "response"] };
const MODES = { live: "Live", polling: "Asked every second", lost: "Connection lost, trying again …" };
const STATES = { queued: "Waiting for a worker", canceled: "Canceled" };

export class Life {
  /**
   * @param {string} id
   * @param {(job: Job) => void} onChange called with the state that a cancellation is answered with
   */
  constructor(id, onChange) {
    this.id = id;
    this.notice = byId("notice");
    this.onChange = onChange;
    /** @type {Job | null} */
    this.job = null;
    /** @type {{ job: string, position: number } | null} */
    this.origin = null;
    this.bell = new Bell(id);
    this.remaining = new Remaining();
    byId("cancel").addEventListener("click", () => this.cancel());
    byId("describe").addEventListener("click", () => this.describe());
    byId("copy-link").addEventListener("click", () => this.copyLink());
    byId("delete").addEventListener("click", () => byId("delete-dialog").showModal());
    byId("delete-dialog").addEventListener("close", () => byId("delete-dialog").returnValue === "delete" && this.remove());
    setInterval(() => this.tick(), 1000);
  }

  /** @param {Job} job */
  show(job) {
    const before = this.job;
    this.job = job;
    const ended = api.isEnded(job);
    const title = job.name ?? `Job ${job.id.slice(-8)}`;
    byId("title").textContent = title;
    document.title = `${job.state === "running" ? `${percent(job.progress)} · ` : ""}${title} · herringbone`;
    const badge = byId("state");
    if (badge.textContent !== job.state) badge.textContent = job.state;
    badge.className = `badge ${job.state}`;
    byId("stage").textContent = describe(job);
    this.remaining.note(job, Date.now());
    this.showProgress(job);
    this.bell.show(!ended);
    if (ended && before && !api.isEnded(before)) this.bell.ring(job, title);
    if (ended) show(byId("mode"), false);
    show(byId("cancel"), !ended);
    byId("cancel").disabled = Boolean(job.cancel_requested_at);
    show(byId("delete"), ended);
    for (const name of ["compare", "report", "download-result", "download-workbook"]) show(byAnyId(name), job.state === "succeeded");
    show(byId("again-optimise"), job.kind === "response");
    show(byId("again-tolerance"), job.kind === "response");
    byId("download-input").href = api.inputUrl(this.id);
    byId("download-rexs").href = api.rexsUrl(this.id);
    byId("download-result").href = api.resultUrl(this.id);
    byId("download-workbook").href = `${api.resultUrl(this.id)}?format=xlsx`;
    this.showValues(job);
    if (job.state === "failed") showFailure(job).then(() => show(byId("life")));
    else show(byId("life"));
    if (job.state === "queued" && before?.state !== "queued") this.askPlace();
    this.tick();
  }

  /** Opens the window in which name, label and notes are changed. */
  async describe() {
    if (!this.job) return;
    const described = await describeJob(this.job);
    if (described) this.show(described);
    byId("describe").focus();
  }

  /** The point of a sweep that the job repeats. @param {{ job: string, position: number }} origin */
  showOrigin(origin) {
    this.origin = origin;
    if (this.job) this.showValues(this.job);
  }

  /** Says how the page gets its news, while the job is live. @param {keyof typeof MODES} mode */
  showMode(mode) {
    const node = byId("mode");
    show(node, !this.job || !api.isEnded(this.job));
    node.dataset.mode = mode;
    if (node.textContent !== MODES[mode]) node.textContent = MODES[mode];
  }

  /** @param {Job} job */
  showValues(job) {
    const solved = job.started_at && job.ended_at && !job.reused_from ? seconds(job.started_at, job.ended_at) : null;
    fillValues(byId("life-values"), [
      ["Kind", { mesh: "Mesh", response: "Response", sweep: "Sweep", optimise: "Optimisation", tolerance: "Tolerance study" }[job.kind] ?? job.kind],
      ["Label", job.label],
      ["Submitted", instant(job.submitted_at)],
      ["Ended", job.ended_at ? instant(job.ended_at) : null],
      ["Point of a sweep", this.origin && el("a", { href: `/jobs/${encodeURIComponent(this.origin.job)}#point=${this.origin.position}` }, `point ${number(this.origin.position + 1)}`)],
      ["Attempt", job.attempt > 1 ? String(job.attempt) : null],
      ["Result taken from", job.reused_from ? el("a", { href: `/jobs/${encodeURIComponent(job.reused_from)}` }, "an equal job") : null],
      ["Solved in", solved === null ? null : number(solved, 3), "s"],
    ]);
    byId("notes").textContent = job.notes ?? "";
    show(byId("notes"), Boolean(job.notes));
  }

  /** @param {Job} job */
  showProgress(job) {
    const progress = byId("progress");
    show(byId("live"), !api.isEnded(job));
    if (job.state === "queued") progress.removeAttribute("value");
    else progress.value = job.progress ?? 0;
    const stages = STAGES_OF[job.kind] ?? [];
    const at = stages.indexOf(job.stage ?? "");
    byId("stages").replaceChildren(
      ...stages.map((stage, index) => {
        const state = index < at ? "done" : index === at ? "current" : "ahead";
        const item = el("li", { class: state }, STAGES[stage]);
        if (state === "current") item.setAttribute("aria-current", "step");
        return item;
      }),
    );
  }

  /** Shows the time since the start of the job, or since its submission. */
  tick() {
    const { job } = this;
    const left = job?.state === "running" ? this.remaining.at(Date.now()) : null;
    byId("left").textContent = left === null ? "" : leftText(left);
    if (!job || api.isEnded(job)) {
      byId("elapsed").textContent = "";
      return;
    }
    const since = (job.state === "running" && job.started_at) || job.submitted_at;
    const span = Math.max(0, Math.round((Date.now() - Date.parse(since)) / 1000));
    byId("elapsed").textContent = `${job.state === "running" ? "for" : "waiting for"} ${span < 90 ? `${span} s` : `${Math.floor(span / 60)} min ${span % 60} s`}`;
  }

  /** Shows how many jobs of its class come before it; single jobs and sweeps have workers of their own. */
  async askPlace() {
    try {
      const { items } = await api.jobs({ state: "queued", limit: 200 });
      const { job } = this;
      if (job?.state !== "queued") return;
      const isSweep = job.kind === "sweep";
      const before = items.filter((other) => (other.kind === "sweep") === isSweep && other.submitted_at < job.submitted_at).length;
      byId("stage").textContent = before ? `${before === 1 ? "1 job is" : `${before} jobs are`} before this one` : "next in the queue";
      setTimeout(() => this.job?.state === "queued" && this.askPlace(), 3000);
    } catch {
      // The place is optional: a failure is not shown.
    }
  }

  async cancel() {
    byId("cancel").disabled = true;
    try {
      this.onChange(await api.cancel(this.id));
    } catch (error) {
      notify(this.notice, error);
    }
  }

  async remove() {
    try {
      await api.remove(this.id);
      window.location.assign("/jobs");
    } catch (error) {
      notify(this.notice, error);
    }
  }

  async copyLink() {
    const link = window.location.href;
    const note = byId("life-note");
    try {
      await navigator.clipboard.writeText(link);
      note.textContent = "The link is on the clipboard.";
    } catch {
      note.textContent = link;
      window.getSelection()?.selectAllChildren(note);
    }
  }
}

/** @param {Job} job */
function describe(job) {
  if (job.cancel_requested_at && !api.isEnded(job)) return "canceling …";
  if (job.state === "running") return [STAGES[job.stage] ?? job.stage, percent(job.progress)].filter(Boolean).join(", ");
  if (job.state === "failed") return job.error?.title ?? "";
  return STATES[job.state] ?? "";
}

/** Shows why a job failed: stage, time, and advice. @param {Job} job */
async function showFailure({ error }) {
  const box = byId("failure");
  if (!error || !box.hidden) return;
  show(box);
  byId("failure-title").textContent = error.title;
  byId("failure-detail").textContent = sentence(readable(error.detail));
  fillValues(byId("failure-values"), [
    ["Stage", STAGES[error.stage] ?? error.stage],
    ["Simulated time", typeof error.sim_time_s === "number" ? number(error.sim_time_s, 4) : null, "s"],
    ["Time step", typeof error.step === "number" ? number(error.step) : null],
    ["Code", el("a", { href: error.type }, error.code)],
    ["Request", error.request_id],
  ]);
  byId("failure-errors").replaceChildren(...(error.errors ?? []).map((entry) => el("li", {}, [placeOf(entry.pointer), readable(entry.detail)].filter(Boolean).join(" "))));
  await explain(error);
}

/** @param {ProblemBody & { type: string }} error */
async function explain({ type }) {
  try {
    const answer = await fetch(type, { headers: { Accept: "application/json" } });
    const { explanation } = await answer.json();
    const text = explanation.replace("Error of a failed job: ", "").replace("`sim_time_s`", "the time below").replaceAll("`", "");
    byId("failure-advice").textContent = sentence(text);
  } catch {
    // Title and detail need no explanation.
  }
}
