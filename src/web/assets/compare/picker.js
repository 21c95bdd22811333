// Choosing a job: the newest first, by name, label or id.

import * as api from "../common/api.js";
import { byId, el, show } from "../common/dom.js";
import { age } from "../common/format.js";
import { nameOf } from "../jobs/words.js";

const PAGE = 100;
const MAX_SHOWN = 60;

/** @type {Job[]} */
let seen = [];
/** @type {string | null} */
let cursor = null;
/** @type {string[]} */
let taken = [];
/** @type {{ chosen: (id: string) => void, failed: (error: unknown) => void }} */
let listeners = { chosen: () => {}, failed: () => {} };

/**
 * Asks for a job that is not among `ids`.
 * @param {string} title
 * @param {string[]} ids
 * @param {(id: string) => void} chosen
 * @param {(error: unknown) => void} failed
 */
export async function pick(title, ids, chosen, failed) {
  listeners = { chosen, failed };
  taken = ids;
  byId("picker-title").textContent = title;
  byId("picker-search").value = "";
  byId("picker-jobs").replaceChildren();
  byId("picker").showModal();
  seen = [];
  cursor = null;
  await more();
}

/** Reads the next page of older jobs. */
async function more() {
  try {
    const page = await api.jobs({ limit: PAGE, cursor });
    seen = seen.concat(page.items);
    cursor = page.next_cursor ?? null;
    fill();
  } catch (error) {
    listeners.failed(error);
  }
}

function fill() {
  const words = byId("picker-search").value.trim().toLowerCase().split(/\s+/).filter(Boolean);
  /** @param {Job} job */
  const fits = (job) => words.every((word) => [nameOf(job), job.label ?? "", job.kind, job.state, job.id].some((text) => text.toLowerCase().includes(word)));
  const fitting = seen.filter((job) => !taken.includes(job.id) && fits(job));
  byId("picker-jobs").replaceChildren(...fitting.slice(0, MAX_SHOWN).map(entry));
  const total = `${fitting.length} of the newest ${seen.length} jobs`;
  byId("picker-note").textContent = fitting.length > MAX_SHOWN ? `${total}; the first ${MAX_SHOWN} are shown.` : `${total}.`;
  show(byId("picker-older"), cursor !== null);
}

/** @param {Job} job */
function entry(job) {
  const facts = [job.kind, job.state === "succeeded" ? "" : job.state, age(job.submitted_at)].filter(Boolean).join(" · ");
  const button = el("button", { type: "button", "data-id": job.id }, el("span", {}, nameOf(job), job.label ? el("span", { class: "label" }, job.label) : null), el("span", { class: "help" }, facts));
  button.addEventListener("click", () => {
    byId("picker").close();
    listeners.chosen(job.id);
  });
  return el("li", {}, button);
}

byId("picker-search").addEventListener("input", fill);
byId("picker-older").addEventListener("click", more);
