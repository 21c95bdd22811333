// Sweeps over the same input, one above the other.

import { byId, el, show } from "../common/dom.js";
import { draw, line } from "../common/plots.js";
import { withUnit } from "../sweep/axes.js";
import { QUANTITIES } from "../sweep/quantities.js";
import { thinned } from "../sweep/thin.js";

/** @typedef {ComparedJob & { sweep: NonNullable<ComparedJob["sweep"]> }} SweptJob */

/** @type {SweptJob[]} */
let jobs = [];

/** Quantities with a column of its own for each half count as two. */
const CHOICES = QUANTITIES.flatMap(({ label, unit, columns }) =>
  Object.entries(columns).map(([half, name]) => ({ name, unit, label: half === "both" ? label : `${label}, ${half}` })));

/** @param {(error: unknown) => void} failed */
export function watchQuantity(failed) {
  const choice = byId("quantity");
  choice.replaceChildren(...CHOICES.map(({ name, label, unit }) => el("option", { value: name }, withUnit(label, unit))));
  choice.addEventListener("change", () => update().catch(failed));
}

/** @type {(job: ComparedJob) => job is SweptJob} */
const isSwept = (job) => job.sweep !== undefined;

/** @param {ComparedJob[]} all @param {ComparedJob} reference */
export async function showSweeps(all, reference) {
  const sweeps = all.filter(isSwept);
  show(byId("sweeps"), sweeps.length > 0);
  const single = sweeps.filter(({ sweep }) => sweep.grid.axes.length === 1);
  const first = single.find((job) => job === reference) ?? single[0];
  /** @param {SweptJob} job */
  const pointerOf = ({ sweep }) => sweep.grid.axes[0].pointer;
  jobs = single.filter((job) => pointerOf(job) === pointerOf(first));
  /** @param {ComparedJob[]} list */
  const letters = (list) => list.map(({ letter }) => letter).join(", ");
  const other = single.filter((job) => !jobs.includes(job));
  const maps = sweeps.filter((job) => !single.includes(job));
  byId("sweeps-note").textContent = [
    other.length ? `${letters(other)}: another input varies; sweeps over the same input are drawn together.` : "",
    maps.length ? `${letters(maps)}: two inputs vary; the pages of these jobs show their maps.` : "",
  ].filter(Boolean).join(" ");
  await update();
}

async function update() {
  const { name, label, unit } = CHOICES.find((choice) => choice.name === byId("quantity").value) ?? CHOICES[0];
  const traces = jobs.flatMap((job) => curvesOf(job, name));
  show(byId("sweep"), traces.length > 0);
  if (!traces.length) return;
  const box = /** @type {HTMLElement} */ (byId("sweep").querySelector(".plot"));
  await draw(box, traces, { x: jobs[0].sweep.grid.axes[0].title, y: unit || label, name: `Sweeps: ${label}`, csvName: `compare-sweeps-${name}` });
  byId("sweeps").dataset.ready = name;
}

/** One curve for each direction of the sweep. @param {SweptJob} job @param {string} name */
function curvesOf({ sweep: { grid, data }, short, slot }, name) {
  const column = data.column(name);
  const x = grid.order.map((first) => grid.axes[0].values[first]);
  return grid.branches.map((branch, index) => {
    const y = Float64Array.from(grid.order, (first) => column[grid.at(first, 0, index)]);
    const kept = thinned(y, 0, y.length);
    const values = kept.map((at) => (Number.isNaN(y[at]) ? null : y[at]));
    const curve = line(kept.map((at) => x[at]), values, [short, branch].filter(Boolean).join(", "));
    return { ...curve, colour: slot, ...(branch === "down" ? { opacity: .65 } : {}) };
  });
}
