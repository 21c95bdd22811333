// The part of a report that only sweeps have: findings, key curves or maps, resonances, points.

import { bodyOf, byId, el, fillRows, show } from "../common/dom.js";
import { number, percent } from "../common/format.js";
import { Grid } from "../sweep/axes.js";
import { curves } from "../sweep/curves.js";
import { SweepData } from "../sweep/data.js";
import { findingsOf } from "../sweep/findings.js";
import { map } from "../sweep/maps.js";
import { ALWAYS, QUANTITIES, columnsOf, quantitiesOf } from "../sweep/quantities.js";
import { campbell, resonancesOf } from "../sweep/resonances.js";
import { HIGH, showFigures } from "./figures.js";

/** Quantities that are drawn, as far as the sweep has them. */
const DRAWN = ["mesh_circumferential_acceleration_rms", "pinion_axial_acceleration_rms", "dynamic_factor", "tooth_force_max", "transmission_error_pp", "k_h_beta", "largest_bearing_force_rms"];
/** @param {SweepQuantity} quantity */
const isDrawn = ({ name }) => DRAWN.some((start) => name.startsWith(start));
/** Lines of a sweep over two inputs that are drawn as curves. */
const MOST_LINES = 3;
/** Points that a report lists; more stand in the file. */
const MOST_POINTS = 250;

/** @param {{ id: string, job: Job, input: JobInput, result: JobResult }} sweep */
export async function showSweep({ id, job, input, result }) {
  const grid = new Grid(input);
  const data = new SweepData(id, grid.total);
  await data.require([...ALWAYS, ...QUANTITIES.flatMap(columnsOf)]);
  await data.refresh();
  /** @type {SweepState} */
  const sweep = { id, name: job.name ?? "Sweep", data, quantities: quantitiesOf(input), rest: result, orders: null };
  /** @type {SweepView} */
  const view = {
    grid, name: "curves", quantity: QUANTITIES[0], kind: null, state: /** @type {any} */ (null), line: grid.secondOrder[0], branch: 0, halves: "both",
    log: false, contours: false, hertz: false, resonances: true, range: null, selected: null, click: () => {},
  };
  const quantities = QUANTITIES.filter(isDrawn).filter((quantity) => columnsOf(quantity).some((name) => varies(data.column(name))));
  byId("sweep-axes").textContent = grid.describeAxes();
  const found = quantities.slice(0, 1).flatMap((quantity) => findingsOf(sweep, { ...view, quantity }));
  byId("sweep-findings").replaceChildren(...found.map(({ text }) => el("li", {}, text)));
  show(byId("sweep-summary"));
  showResonances(sweep, view);
  showPoints(sweep, view);
  await showFigures(grid.axes.length === 2 ? maps(sweep, view, quantities) : lines(sweep, view, quantities));
}

/** @param {ArrayLike<number>} column */
const varies = (column) => Array.from(column).some((value) => !Number.isNaN(value) && value !== column[0]);

/** @param {SweepState} sweep @param {SweepView} view @param {SweepQuantity[]} quantities */
function lines(sweep, view, quantities) {
  const all = quantities.map((quantity) => ({ title: quantity.label, ...curves(sweep, { ...view, quantity }), size: HIGH }));
  const diagram = campbell(sweep, view);
  return diagram ? [...all, { title: "Campbell diagram", ...diagram, size: HIGH }] : all;
}

/**
 * A map of each quantity and branch, the kinds of motion, and the curves of the first lines.
 * @param {SweepState} sweep
 * @param {SweepView} view
 * @param {SweepQuantity[]} quantities
 */
function maps(sweep, view, quantities) {
  const { grid } = view;
  const branches = [...grid.branches.keys()];
  /** @param {string} title @param {SweepView} chosen */
  const drawn = (title, chosen) => {
    const plot = map(sweep, chosen);
    const branch = grid.branches[chosen.branch];
    return { title: [title, branch ? `on the way ${branch}` : ""].filter(Boolean).join(", "), ...plot, axes: { ...plot.axes, title: undefined }, size: HIGH };
  };
  const all = quantities.flatMap((quantity) => branches.map((branch) => drawn([quantity.label, quantity.unit].filter(Boolean).join(", "), { ...view, quantity, branch })));
  const kinds = branches.map((branch) => drawn("Kind of motion", { ...view, kind: "regime", branch }));
  const [, second] = grid.axes;
  const along = grid.secondOrder.slice(0, MOST_LINES).flatMap((line) => quantities.slice(0, 1).map((quantity) => ({
    title: `${quantity.label} at ${second.label.toLowerCase()} ${number(second.values[line], 7)} ${second.unit}`, ...curves(sweep, { ...view, quantity, line }), size: HIGH,
  })));
  return [...all, ...kinds, ...along];
}

/** @param {SweepState} sweep @param {SweepView} view */
function showResonances(sweep, view) {
  const { values } = view.grid.axes[0];
  const found = resonancesOf(sweep.rest, view, [Math.min(...values), Math.max(...values)]).sort((a, b) => a.at - b.at);
  fillRows(byId("resonances-table").tBodies[0], found.map(({ at, order, mode, share }) => [number(at, 5), number(order), number(mode.frequency_hz, 5), percent(share).replace(" %", ""), mode.name]));
  show(byId("resonances"), found.length > 0);
}

/** @param {SweepState} sweep @param {SweepView} view */
function showPoints({ data, quantities }, { grid }) {
  const shown = quantities.filter(isDrawn).flatMap(({ label, unit, columns }) =>
    Object.entries(columns).filter(([, name]) => varies(data.column(name))).map(([half, name]) => ({ name, title: [label, half === "both" ? "" : half, unit].filter(Boolean).join(", ") })));
  const branched = grid.branches.length > 1;
  const names = [...grid.axes.map(({ title }) => title), ...(branched ? ["Branch"] : []), ...shown.map(({ title }) => title), "Motion", "Contact"];
  byId("points-table").tHead?.replaceChildren(el("tr", {}, ...names.map((name) => el("th", { scope: "col" }, name))));
  const positions = Array.from({ length: Math.min(grid.total, MOST_POINTS) }, (_, position) => position);
  fillRows(bodyOf(byId("points-table")), positions.map((position) => [
    ...grid.valuesAt(position).map((value) => number(value, 7)), ...(branched ? [grid.branches[grid.placeOf(position).branch]] : []),
    ...shown.map(({ name }) => number(data.column(name)[position])), data.column("error")[position] || data.column("regime")[position], data.column("contact")[position] ?? "–",
  ]));
  byId("points-note").textContent = grid.total > MOST_POINTS ? `The first ${MOST_POINTS} of ${number(grid.total)} points; the file of all is on the page of the sweep.` : "";
  show(byId("points"));
}
