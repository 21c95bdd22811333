// Choosing a job: the newest first, by name, label or id.

import * as api from "../common/api.js";
import { byId, el, show } from "../common/dom.js";
import { age } from "../common/format.js";
import { nameOf } from "../jobs/words.js";

const PAGE = 100;
const MAX_SHOWN = 60;

let seen = [];
let cursor = null;
let chosen = () => {};
let taken = [];

/** Asks for a job that is not among `ids`, and hands its id to `onChoice`. */
export async function pick(title, ids, onChoice, failed) {
  chosen = onChoice;
  taken = ids;
  byId("picker-title").textContent = title;
  byId("picker-search").value = "";
  byId("picker-jobs").replaceChildren();
  byId("picker").showModal();
  seen = [];
  cursor = null;
  await more().catch(failed);
}

async function more() {
  const page = await api.jobs({ limit: PAGE, cursor });
  seen = seen.concat(page.items);
  cursor = page.next_cursor ?? null;
  fill();
}

function fill() {
  const words = byId("picker-search").value.trim().toLowerCase().split(/\s+/).filter(Boolean);
  const fits = (job) => words.every((word) => [nameOf(job), job.label ?? "", job.kind, job.state, job.id].some((text) => text.toLowerCase().includes(word)));
  const fitting = seen.filter((job) => !taken.includes(job.id) && fits(job));
  byId("picker-jobs").replaceChildren(...fitting.slice(0, MAX_SHOWN).map(entry));
  const total = `${fitting.length} of the newest ${seen.length} jobs`;
  byId("picker-note").textContent = fitting.length > MAX_SHOWN ? `${total}; the first ${MAX_SHOWN} are shown.` : `${total}.`;
  show(byId("picker-older"), cursor !== null);
}

function entry(job) {
  const facts = [job.kind, job.state === "succeeded" ? "" : job.state, age(job.submitted_at)].filter(Boolean).join(" · ");
  const button = el("button", { type: "button", "data-id": job.id }, el("span", {}, nameOf(job), job.label ? el("span", { class: "label" }, job.label) : null), el("span", { class: "help" }, facts));
  button.addEventListener("click", () => {
    byId("picker").close();
    chosen(job.id);
  });
  return el("li", {}, button);
}

byId("picker-search").addEventListener("input", fill);
byId("picker-older").addEventListener("click", more);
