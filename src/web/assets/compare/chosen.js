// A card for each compared job, with its line as in every figure.

import { byId, el } from "../common/dom.js";
import { age } from "../common/format.js";
import { readable } from "../common/sentence.js";
import { describeState, stateBadge } from "../common/state.js";
import { MOST } from "./address.js";

const SVG = "http://www.w3.org/2000/svg";
/** Dashes of the lines, as in the figures. */
const DASHES = ["", "6 4", "2 3", "6 3 2 3", "10 4"];

/** A short line in a job's colour and dash, with its letter. @param {string} letter @param {number} slot */
export function mark(letter, slot) {
  const svg = document.createElementNS(SVG, "svg");
  const path = document.createElementNS(SVG, "path");
  for (const [name, value] of Object.entries({ viewBox: "0 0 26 10", width: "26", height: "10", "aria-hidden": "true" })) svg.setAttribute(name, value);
  for (const [name, value] of Object.entries({ d: "M0 5H26", "stroke-dasharray": DASHES[slot] })) path.setAttribute(name, value);
  svg.append(path);
  return el("span", { class: `mark slot-${slot}` }, svg, el("b", {}, letter));
}

/**
 * @param {ComparedJob[]} jobs
 * @param {ComparedJob} reference
 * @param {Actions} acts
 *
 * @typedef {{
 *   add: () => void,
 *   replace: (id: string) => void,
 *   remove: (id: string) => void,
 *   refer: (id: string) => void,
 * }} Actions
 */
export function showChosen(jobs, reference, acts) {
  const list = byId("chosen");
  const focused = /** @type {HTMLElement | null} */ (document.activeElement)?.dataset?.act;
  const cards = jobs.map((job) => card(job, job === reference, jobs.length, acts));
  if (jobs.length < MOST) {
    const add = button("Add a job …", "add", acts.add);
    const hint = jobs.length === 0 ? "Two to five jobs can be compared." : jobs.length === 1 ? "One more is needed to compare." : "";
    cards.push(el("li", { class: "add" }, add, hint ? el("p", { class: "help" }, hint) : null));
  }
  list.replaceChildren(...cards);
  if (!focused) return;
  const next = list.querySelector(`[data-act="${CSS.escape(focused)}"]`) ?? list.querySelector("[data-act=add]") ?? list.querySelector("a");
  /** @type {HTMLElement | null} */ (next)?.focus();
}

/** @param {string} text @param {string} act @param {() => void} run @param {string} [label] */
function button(text, act, run, label) {
  const made = el("button", { type: "button", class: act === "add" ? "" : "quiet", "data-act": act, "aria-label": label }, text);
  made.addEventListener("click", run);
  return made;
}

/** @param {ComparedJob} entry @param {boolean} isReference @param {number} total @param {Actions} acts */
function card({ id, letter, slot, job, name }, isReference, total, acts) {
  const choice = el("input", { type: "radio", name: "reference", value: id, checked: isReference, "data-act": `refer ${id}` });
  choice.addEventListener("change", () => acts.refer(id));
  const title = job ? el("a", { href: `/jobs/${encodeURIComponent(id)}` }, name) : el("span", {}, name);
  return el(
    "li",
    { class: `card slot-${slot}`, "data-id": id },
    el("p", { class: "who" }, mark(letter, slot), el("span", {}, title, job?.label ? el("span", { class: "label" }, job.label) : null)),
    el("p", { class: "help facts" }, ...facts(job)),
    el(
      "div",
      { class: "acts" },
      total > 1 ? el("label", { class: "option" }, choice, "Reference") : null,
      button("Replace", `replace ${id}`, () => acts.replace(id), `Replace ${name}`),
      button("Remove", `remove ${id}`, () => acts.remove(id), `Remove ${name} from the comparison`),
    ),
  );
}

/** @param {Job | null} job @returns {Child[]} */
function facts(job) {
  if (!job) return ["There is no such job: it may have been deleted."];
  const base = `${job.kind}, ${age(job.submitted_at)}`;
  if (job.state === "succeeded") return [job.kind === "mesh" ? `${base}; stages up to the impact, no vibration` : base];
  /** @type {Record<string, string>} */
  const words = { queued: "It waits for a worker; its result appears here.", running: "Its result appears here.", failed: [job.error?.title, readable(job.error?.detail)].filter(Boolean).join(": "), canceled: "It has no result; its inputs are compared." };
  return [`${base} `, stateBadge(job), ` ${describeState(job)} `, words[job.state]];
}
