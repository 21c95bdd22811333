// Sweeps over the same input, one above the other.

import { byId, el, show } from "../common/dom.js";
import { draw, line } from "../common/plots.js";
import { withUnit } from "../sweep/axes.js";
import { QUANTITIES } from "../sweep/quantities.js";
import { thinned } from "../sweep/thin.js";
import * as address from "./address.js";

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
  if (CHOICES.some(({ name }) => name === address.told().get("quantity"))) choice.value = address.told().get("quantity") ?? "";
  choice.addEventListener("change", () => {
    address.remember({ quantity: choice.value === CHOICES[0].name ? "" : choice.value });
    update().catch(failed);
  });
}

/** @type {(job: ComparedJob) => job is SweptJob} */
const isSwept = (job) => job.sweep !== undefined;

/** @param {ComparedJob[]} all @param {ComparedJob} reference */
export async function showSweeps(all, reference) {
  const sweeps = all.filter(isSwept);
  show(byId("sweeps"), sweeps.length > 0);
  const single = sweeps.filter(({ sweep }) => sweep.grid.axes.length === 1);
  jobs = drawnTogether(sweeps, reference);
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
  const found = figureOf(byId("quantity").value);
  show(byId("sweep"), found !== null);
  if (!found) return;
  const box = /** @type {HTMLElement} */ (byId("sweep").querySelector(".plot"));
  await draw(box, found.traces, found.axes);
  byId("sweeps").dataset.ready = found.name;
}

/**
 * A quantity of the sweeps that are drawn together; null without any.
 * @param {string | null} wanted name of a column
 */
function figureOf(wanted) {
  const { name, label, unit } = CHOICES.find((choice) => choice.name === wanted) ?? CHOICES[0];
  const traces = jobs.flatMap((job) => curvesOf(job, name));
  if (!traces.length) return null;
  return { name, traces, axes: { x: jobs[0].sweep.grid.axes[0].title, y: { label, unit }, name: `Sweeps: ${label}`, csvName: `compare-sweeps-${name}` } };
}

/** The same for a report, of the quantity in the address. @param {ComparedJob[]} all @param {ComparedJob} reference */
export function sweepFigureOf(all, reference) {
  jobs = drawnTogether(all.filter(isSwept), reference);
  return figureOf(address.told().get("quantity"));
}

/** Sweeps over one input, the same as the reference's. @param {SweptJob[]} sweeps @param {ComparedJob} reference */
function drawnTogether(sweeps, reference) {
  const single = sweeps.filter(({ sweep }) => sweep.grid.axes.length === 1);
  const first = single.find((job) => job === reference) ?? single[0];
  return single.filter(({ sweep }) => sweep.grid.axes[0].pointer === first.sweep.grid.axes[0].pointer);
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
    return { ...curve, colour: slot, ...(branch ? { line: { width: branch === "down" ? 1.1 : 2.4 } } : {}) };
  });
}
