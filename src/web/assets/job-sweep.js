// A sweep: one quantity over one or two inputs, and the table of all points.

import { byId, el, fillRows, show } from "./dom.js";
import { labelOf, number, pointerLabel, unitOf } from "./format.js";
import { draw, heatMap, line } from "./plots.js";

/** Rows of the table; more would only slow the page down, and the result file has them all. */
const MAX_ROWS = 2000;
const NOT_QUANTITIES = ["values", "regime", "contact", "error"];

export async function showSweep({ sweep }) {
  if (!sweep?.points?.length) return;
  show(byId("sweep"));
  const { axes, points } = sweep;
  const quantities = quantitiesOf(points);
  const choice = byId("sweep-quantity");
  choice.append(...quantities.map((quantity, index) => el("option", { value: String(index) }, withUnit(quantity.label, quantity.unit))));
  const update = () => plot(axes, points, quantities[Number(choice.value)]);
  choice.addEventListener("change", update);
  fillTable(axes, points, quantities);
  const failed = points.filter((point) => point.error).length;
  byId("sweep-note").textContent = [
    failed ? `${failed} of ${points.length} points have no response; the table says why.` : "",
    points.length > MAX_ROWS ? `The table shows the first ${MAX_ROWS} of ${points.length} points; the result file has all.` : "",
  ].join(" ");
  if (quantities.length) await update();
}

/** Every number that some point has; a value per half counts as two. */
function quantitiesOf(points) {
  const quantities = [];
  for (const name of Object.keys(points[0]).filter((name) => !NOT_QUANTITIES.includes(name))) {
    const sample = points.find((point) => point[name] !== null && point[name] !== undefined)?.[name];
    if (sample === undefined) continue;
    const label = labelOf(name).replace(" rms", ", RMS");
    const unit = unitOf(name);
    if (typeof sample === "object") {
      quantities.push({ label: `${label}, left`, unit, pick: (point) => point[name]?.left, partner: (point) => point[name]?.right });
      quantities.push({ label: `${label}, right`, unit, pick: (point) => point[name]?.right });
    } else if (typeof sample === "number") {
      quantities.push({ label, unit, pick: (point) => point[name] });
    }
  }
  return quantities;
}

async function plot(axes, points, quantity) {
  const labels = axes.map((axis) => pointerLabel(axis.pointer)).map(({ label, unit }) => withUnit(label, unit));
  const y = withUnit(quantity.label, quantity.unit);
  if (axes.length === 1) {
    const sorted = [...points].sort((a, b) => a.values[0] - b.values[0]);
    const x = sorted.map((point) => point.values[0]);
    const traces = [line(x, sorted.map(quantity.pick), quantity.partner ? "left" : "")];
    if (quantity.partner) traces.push(line(x, sorted.map(quantity.partner), "right"));
    await draw(byId("sweep-plot"), traces, { x: labels[0], y: quantity.unit || quantity.label });
  } else {
    const [columns, rows] = axes.map((_, index) => [...new Set(points.map((point) => point.values[index]))].sort((a, b) => a - b));
    const byPlace = new Map(points.map((point) => [point.values.join(), quantity.pick(point)]));
    const grid = rows.map((row) => columns.map((column) => byPlace.get([column, row].join()) ?? null));
    await draw(byId("sweep-plot"), [heatMap(columns, rows, grid, quantity.unit)], { x: labels[0], y: labels[1], title: y });
  }
}

function fillTable(axes, points, quantities) {
  const table = byId("sweep-table");
  const names = [...axes.map((axis) => pointerLabel(axis.pointer)).map(({ label, unit }) => withUnit(label, unit)), ...quantities.map(({ label, unit }) => withUnit(label, unit)), "Regime", "Contact", "Error"];
  table.tHead.replaceChildren(el("tr", {}, ...names.map((name) => el("th", { scope: "col" }, name))));
  const fill = () =>
    fillRows(table.tBodies[0], points.slice(0, MAX_ROWS).map((point) => [
      ...point.values.map((value) => number(value)), ...quantities.map(({ pick }) => number(pick(point))), point.regime ?? "–", point.contact ?? "–", point.error ?? "",
    ]));
  byId("sweep-details").addEventListener("toggle", fill, { once: true });
}

const withUnit = (label, unit) => (unit ? `${label}, ${unit}` : label);
