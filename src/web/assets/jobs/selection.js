// The selected jobs, over the pages of the list, and the actions on all of them.

import * as api from "../common/api.js";
import { byId, el, show } from "../common/dom.js";
import { count, nameOf } from "./words.js";

const MIN_COMPARED = 2;
const MAX_COMPARED = 5;
/** Names that a question lists; requests at once. */
const MAX_NAMES = 8;
const AT_ONCE = 4;

export class Selection {
  /**
   * `rows` gives the rows shown, in order.
   * @param {{
   *   rows: () => import("./rows.js").Row[],
   *   changed: (job: Job) => void,
   *   removed: (id: string) => void,
   *   failed: (errors: unknown[]) => void,
   * }} list
   */
  constructor({ rows, changed, removed, failed }) {
    this.rows = rows;
    this.changed = changed;
    this.removed = removed;
    this.failed = failed;
    /** @type {Map<string, Job>} */
    this.jobs = new Map();
    /** @type {import("./rows.js").Row | null} */
    this.last = null;
    byId("select-all").addEventListener("click", () => this.all(byId("select-all").checked));
    byId("clear-selection").addEventListener("click", () => {
      this.jobs.clear();
      this.show();
      byId("select-all").focus();
    });
    byId("compare").addEventListener("click", () => {
      window.location.assign(`/compare?jobs=${[...this.jobs.keys()].join(",")}`);
    });
    byId("cancel-selected").addEventListener("click", () => this.cancel());
    byId("delete-selected").addEventListener("click", () => this.remove([...this.jobs.values()]));
  }

  /**
   * A click on the box of a row; with Shift, on all boxes since the last click.
   * @param {import("./rows.js").Row} row
   * @param {boolean} isRange
   */
  pick(row, isRange) {
    const rows = this.rows();
    const [from, to] = [this.last ? rows.indexOf(this.last) : -1, rows.indexOf(row)].sort((a, b) => a - b);
    const picked = isRange && from >= 0 ? rows.slice(from, to + 1) : [row];
    for (const { job } of picked) this.set(job, row.box.checked);
    this.last = row;
    this.show();
  }

  /** @param {boolean} isSelected */
  all(isSelected) {
    for (const { job } of this.rows()) this.set(job, isSelected);
    this.show();
  }

  /** @param {Job} job @param {boolean} isSelected */
  set(job, isSelected) {
    if (isSelected) this.jobs.set(job.id, job);
    else this.jobs.delete(job.id);
  }

  /** Takes up that a selected job has changed. @param {Job} job */
  know(job) {
    const known = this.jobs.get(job.id);
    if (known && known.revision <= job.revision) this.jobs.set(job.id, job);
  }

  /** @param {string} id */
  forget(id) {
    this.jobs.delete(id);
  }

  show() {
    const rows = this.rows();
    for (const row of rows) {
      row.box.checked = this.jobs.has(row.job.id);
      row.node.classList.toggle("selected", row.box.checked);
    }
    const here = rows.filter((row) => row.box.checked).length;
    const total = this.jobs.size;
    const all = byId("select-all");
    all.checked = here > 0 && here === rows.length;
    all.indeterminate = here > 0 && here < rows.length;
    all.disabled = rows.length === 0;
    const elsewhere = total > here ? `, ${total - here} of them not on this page` : "";
    byId("selected").textContent = total ? `${total} selected${elsewhere}` : "None selected";
    const live = [...this.jobs.values()].filter((job) => !api.isEnded(job)).length;
    byId("cancel-selected").disabled = live === 0;
    byId("delete-selected").disabled = total - live === 0;
    /** @type {HTMLButtonElement} */ (byId("compare")).disabled = total < MIN_COMPARED || total > MAX_COMPARED;
    byId("compare-hint").textContent = hint(total);
    show(byId("clear-selection"), total > 0);
  }

  /** Cancels those that have not ended, after a question. */
  async cancel() {
    const live = [...this.jobs.values()].filter((job) => !api.isEnded(job));
    const question = {
      title: `Cancel ${count(live.length)}?`,
      jobs: live,
      text: "What they have computed so far is lost, but for the points of a sweep.",
      yes: `Cancel ${count(live.length)}`,
      no: "Let run",
    };
    if (live.length && (await confirmed(question))) await this.each(live, (job) => this.stop(job));
  }

  /** @param {Job} job */
  async stop(job) {
    this.changed(await api.cancel(job.id));
  }

  /** Deletes those that have ended, after a question. @param {Job[]} jobs */
  async remove(jobs) {
    const ended = jobs.filter(api.isEnded);
    const left = jobs.length - ended.length;
    const question = {
      title: ended.length === 1 ? "Delete this job?" : `Delete ${count(ended.length)}?`,
      jobs: ended,
      text: [
        ended.length === 1 ? "Its document, result and series go with it: there is no way back." : "Their documents, results and series go with them: there is no way back.",
        left ? `${count(left)} of the selection ${left === 1 ? "has" : "have"} not ended and ${left === 1 ? "stays" : "stay"}: cancel first.` : "",
      ].join(" "),
      yes: ended.length === 1 ? "Delete" : `Delete ${count(ended.length)}`,
    };
    if (ended.length && (await confirmed(question))) await this.each(ended, (job) => this.drop(job));
  }

  /** @param {Job} job */
  async drop({ id }) {
    try {
      await api.remove(id);
    } catch (error) {
      // Another client has deleted it.
      if (!(error instanceof api.Problem && error.status === 404)) throw error;
    }
    this.removed(id);
  }

  /**
   * Does the same with many jobs, a few at a time; all errors are reported at the end.
   * @param {Job[]} jobs
   * @param {(job: Job) => Promise<void>} run
   */
  async each(jobs, run) {
    const waiting = [...jobs];
    /** @type {unknown[]} */
    const errors = [];
    const work = async () => {
      for (let job = waiting.shift(); job; job = waiting.shift()) {
        try {
          await run(job);
        } catch (error) {
          errors.push(error);
        }
      }
    };
    await Promise.all(Array.from({ length: AT_ONCE }, work));
    this.failed(errors);
  }
}

/** @param {number} total */
function hint(total) {
  if (total > MAX_COMPARED) return `At most five jobs can be compared; clear ${total - MAX_COMPARED} of them.`;
  if (total === 1) return "Select one more job to compare.";
  return total === 0 ? "Select two to five jobs to compare." : "";
}

/**
 * Asks in a dialog; Escape and the button that has the focus mean no.
 * @param {{ title: string, jobs: Job[], text: string, yes: string, no?: string }} question
 * @returns {Promise<boolean>}
 */
function confirmed({ title, jobs, text, yes, no = "Keep" }) {
  const dialog = byId("confirm");
  const names = jobs.slice(0, MAX_NAMES).map((job) => el("li", {}, nameOf(job)));
  if (jobs.length > MAX_NAMES) names.push(el("li", {}, `and ${jobs.length - MAX_NAMES} more`));
  byId("confirm-title").textContent = title;
  byId("confirm-jobs").replaceChildren(...names);
  byId("confirm-text").textContent = text;
  byId("confirm-yes").textContent = yes;
  byId("confirm-no").textContent = no;
  dialog.returnValue = "no";
  dialog.showModal();
  return new Promise((resolve) => {
    dialog.addEventListener("close", () => resolve(dialog.returnValue === "yes"), { once: true });
  });
}
