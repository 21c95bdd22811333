// The rows of the list: made once per job, then changed in place, so that focus and selection stay where they are.

import * as api from "../common/api.js";
import { el, show } from "../common/dom.js";
import { age, dayAndTime, instant, number } from "../common/format.js";
import { readable } from "../common/sentence.js";
import { duration, durationOf, nameOf } from "./words.js";

/**
 * Headline numbers: their members of a job, names and units.
 * @type {[keyof NonNullable<Job["headline"]>, string, string][]}
 */
const VALUES = [
  ["mesh_circumferential_acceleration_rms_m_s2", "RMS", "m/s²"],
  ["dynamic_factor", "Dynamic factor", ""],
  ["transmission_error_pp_um", "TE", "µm"],
];

/** One row of the list. */
export class Row {
  /**
   * @param {Job} job
   * @param {{
   *   select: (row: Row, isRange: boolean) => void,
   *   filter: (label: string) => void,
   *   describe: (job: Job, opener: HTMLElement) => void,
   *   cancel: (job: Job) => void,
   *   remove: (job: Job) => void,
   * }} actions of its buttons
   */
  constructor(job, actions) {
    this.job = job;
    this.isFilled = false;
    /** @type {string | undefined} */
    this.place = undefined;
    this.link = el("a", {});
    this.label = el("button", { type: "button", class: "label" });
    this.kind = el("td", { class: "kind" });
    this.badge = el("span", { class: "badge" });
    this.stage = el("span", { class: "stage" });
    this.bar = el("progress", { max: 1 });
    this.values = VALUES.map(([, name, unit]) => el("td", { class: "value", title: unit ? `${name}, ${unit}` : name, "data-name": name, "data-unit": unit }));
    this.notes = el("span", { class: "notes" });
    this.age = el("td", { class: "age" });
    this.duration = el("td", { class: "duration" });
    this.box = el("input", { type: "checkbox" });
    this.describe = el("button", { type: "button", class: "quiet plain describe-job" }, "Edit");
    this.clone = el("a", { class: "button quiet" }, "Clone");
    this.cancel = el("button", { type: "button", class: "quiet" }, "Cancel");
    this.remove = el("button", { type: "button", class: "quiet" }, "Delete");
    this.node = el(
      "tr",
      { "data-id": job.id },
      el("td", { class: "pick" }, el("label", { class: "hit" }, this.box)),
      el("th", { scope: "row" }, el("span", { class: "title" }, this.link, this.label, this.describe), this.notes),
      this.kind,
      el("td", { class: "state" }, el("span", { class: "words" }, this.badge, this.stage), this.bar),
      ...this.values,
      this.age,
      this.duration,
      el("td", { class: "row-actions" }, this.clone, this.cancel, this.remove),
    );
    this.box.addEventListener("click", (event) => actions.select(this, event.shiftKey));
    this.label.addEventListener("click", () => actions.filter(this.job.label ?? ""));
    this.describe.addEventListener("click", () => actions.describe(this.job, this.describe));
    this.cancel.addEventListener("click", () => actions.cancel(this.job));
    this.remove.addEventListener("click", () => actions.remove(this.job));
    this.update(job);
  }

  /** Shows a newer state of the job; an older one changes nothing. True when it has ended just now. @param {Job} job */
  update(job) {
    if (job.revision < this.job.revision) return false;
    const ended = this.isFilled && !api.isEnded(this.job) && api.isEnded(job);
    this.job = job;
    this.isFilled = true;
    const name = nameOf(job);
    write(this.link, name);
    this.link.href = `/jobs/${encodeURIComponent(job.id)}`;
    this.link.classList.toggle("unnamed", !job.name);
    write(this.label, job.label ?? "");
    this.label.title = "Only jobs with this label";
    this.label.setAttribute("aria-label", `Label ${job.label}: show only these jobs`);
    show(this.label, Boolean(job.label));
    write(this.kind, job.kind);
    write(this.badge, job.state);
    this.badge.className = `badge ${job.state}`;
    const [words, title] = stageOf(job);
    write(this.stage, words);
    this.stage.title = title;
    this.stage.classList.toggle("reason", job.state === "failed");
    show(this.bar, job.state === "running");
    this.bar.value = job.progress ?? 0;
    this.bar.setAttribute("aria-label", `Progress of ${name}`);
    write(this.notes, job.notes ?? "");
    show(this.notes, Boolean(job.notes));
    VALUES.forEach(([member], index) => {
      const value = job.headline?.[member];
      write(this.values[index], typeof value === "number" ? number(value, 4) : "");
    });
    write(this.age, dayAndTime(job.submitted_at));
    this.clone.href = `/?from=${encodeURIComponent(job.id)}`;
    this.clone.title = "Open its document in the form, as a new job";
    const live = !api.isEnded(job);
    // A button that goes while it has the focus hands it on.
    if (!live && document.activeElement === this.cancel) this.link.focus();
    show(this.cancel, live);
    show(this.remove, !live);
    this.cancel.disabled = Boolean(job.cancel_requested_at);
    this.describe.title = "Change name, label and notes";
    this.describe.setAttribute("aria-label", `Edit name, label and notes of ${name}`);
    this.clone.setAttribute("aria-label", `Clone ${name}`);
    this.cancel.setAttribute("aria-label", `Cancel ${name}`);
    this.remove.setAttribute("aria-label", `Delete ${name}`);
    this.box.setAttribute("aria-label", `Select ${name}`);
    this.tick();
    return ended;
  }

  /** Updates the texts that depend on the present time. */
  tick(now = Date.now()) {
    const { job } = this;
    this.age.title = `${instant(job.submitted_at)}, ${age(job.submitted_at, now)}`;
    const span = durationOf(job, now);
    write(this.duration, span === null ? "" : duration(span));
  }

  /** Whether what the list is sorted by has changed since this was last asked. @param {string} sort */
  hasMoved(sort) {
    const { name, label, ended_at: ended, headline } = this.job;
    const [by] = sort.split("-");
    const value = by === "submitted" ? "" : JSON.stringify(by === "name" ? name : by === "label" ? label : by === "ended" ? ended : headline);
    const moved = this.place !== undefined && this.place !== `${by} ${value}`;
    this.place = `${by} ${value}`;
    return moved;
  }

  /** Whether the focus is in this row, which then is not removed. */
  get hasFocus() {
    return this.node.contains(document.activeElement);
  }
}

/**
 * Stage of a live job or outcome of an ended one as short text, and the full text.
 * @param {Job} job
 * @returns {[string, string]}
 */
function stageOf(job) {
  if (!api.isEnded(job) && job.cancel_requested_at) return ["canceling …", ""];
  if (job.state === "running") return [[percent(job.progress ?? 0), job.stage].filter(Boolean).join(" · "), ""];
  if (job.state === "queued" && job.attempt > 0) return ["waits to go on", "It was interrupted, and goes on when a worker is free"];
  if (job.state === "failed") return [job.error?.title ?? "", readable(job.error?.detail)];
  if (job.reused_from) return ["result of an equal job", "The input was the same: the stored result was taken"];
  return ["", ""];
}

/** Progress, with a decimal below 10 %. @param {number} fraction */
function percent(fraction) {
  if (fraction > 0 && fraction < .0005) return "below 0.1 %";
  return `${fraction > 0 && fraction < .0995 ? (100 * fraction).toFixed(1) : Math.round(100 * fraction)} %`;
}

/** Changes a text only when it differs: selections in the page stay. @param {HTMLElement} node @param {string} text */
function write(node, text) {
  if (node.textContent !== text) node.textContent = text;
}
