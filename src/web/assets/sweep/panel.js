// A sweep: one quantity over one or two inputs, and the table of all points.

import * as api from "../common/api.js";
import { byId, el, fillRows, show } from "../common/dom.js";
import { labelOf, number, pointerLabel, unitOf } from "../common/format.js";
import { draw, heatMap, line, points as dots } from "../common/plots.js";

/** Rows of the table; more would only slow the page down, and the result file has them all. */
const MAX_ROWS = 2000;
const NOT_QUANTITIES = ["values", "regime", "contact", "error", "branch", "poincare", "acceleration_spectrum_m_s2"];
let shown = false;

/** Called with every change of the job's state or progress. */
export async function showSweep({ id, job }) {
  if (job.state !== "succeeded" || shown) return;
  shown = true;
  const { sweep } = await api.result(id);
  if (!sweep?.points?.length) return;
  show(byId("sweep"));
  const { axes, points } = sweep;
  const quantities = quantitiesOf(points);
  const pictures = [
    ...quantities.map((quantity) => ({ label: withUnit(quantity.label, quantity.unit), show: () => plot(axes, points, quantity) })),
    ...(axes.length === 1 ? picturesOf(sweep) : []),
  ];
  const choice = byId("sweep-quantity");
  choice.append(...pictures.map(({ label }, index) => el("option", { value: String(index) }, label)));
  const update = () => pictures[Number(choice.value)].show();
  choice.addEventListener("change", update);
  fillTable(axes, points, quantities);
  const failed = points.filter((point) => point.error).length;
  byId("sweep-note").textContent = [
    ...(sweep.hysteresis ?? []).map(({ from, to }) => `Two motions between ${number(from)} and ${number(to)}.`),
    ...(sweep.jumps ?? []).map(({ branch, from, to }) => `Jump on the way ${branch} from ${number(from)} to ${number(to)}.`),
    failed ? `${failed} of ${points.length} points have no response; the table says why.` : "",
    points.length > MAX_ROWS ? `The table shows the first ${MAX_ROWS} of ${points.length} points; the result file has all.` : "",
  ].join(" ");
  if (pictures.length) await update();
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
    const traces = branchesOf(points).flatMap(({ branch, sorted }) => {
      const x = sorted.map((point) => point.values[0]);
      const name = (half) => [half, branch].filter(Boolean).join(", ");
      const left = line(x, sorted.map(quantity.pick), name(quantity.partner ? "left" : ""));
      return quantity.partner ? [left, line(x, sorted.map(quantity.partner), name("right"))] : [left];
    });
    await draw(byId("sweep-plot"), traces, { x: labels[0], y: quantity.unit || quantity.label });
  } else {
    const [columns, rows] = axes.map((_, index) => [...new Set(points.map((point) => point.values[index]))].sort((a, b) => a - b));
    // Of two directions of continuation the first is shown.
    const [{ branch, sorted }] = branchesOf(points);
    const byPlace = new Map(sorted.map((point) => [point.values.join(), quantity.pick(point)]));
    const grid = rows.map((row) => columns.map((column) => byPlace.get([column, row].join()) ?? null));
    await draw(byId("sweep-plot"), [heatMap(columns, rows, grid, quantity.unit)], { x: labels[0], y: labels[1], title: [y, branch].filter(Boolean).join(", ") });
  }
}

/** The points in the order of the axis, one list per direction of continuation. */
function branchesOf(points) {
  const branches = [...new Set(points.map((point) => point.branch ?? ""))];
  return branches.map((branch) => ({
    branch,
    sorted: points.filter((point) => (point.branch ?? "") === branch).sort((a, b) => a.values[0] - b.values[0]),
  }));
}

/** Bifurcation diagram, waterfall and Campbell diagram, as far as the sweep has them. */
function picturesOf({ axes, points, spectrum_mesh_orders: orders, campbell }) {
  const { label, unit } = pointerLabel(axes[0].pointer);
  const x = withUnit(label, unit);
  const pictures = [];
  if (points.some((point) => point.poincare)) {
    const show = () => {
      const traces = branchesOf(points).map(({ branch, sorted }) => {
        const all = sorted.flatMap((point) => (point.poincare?.x_left_m ?? []).map((place) => [point.values[0], place * 1e6]));
        return { ...dots(all.map(([at]) => at), all.map(([, place]) => place), branch), marker: { size: 3 } };
      });
      return draw(byId("sweep-plot"), traces, { x, y: "µm", title: "x left at the starts of mesh periods, µm" });
    };
    pictures.push({ label: "Bifurcation: x left at the starts of mesh periods, µm", show });
  }
  if (orders) {
    for (const { branch, sorted } of branchesOf(points)) {
      const rows = sorted.filter((point) => point.acceleration_spectrum_m_s2);
      const values = rows.map((point) => point.values[0]);
      const grid = orders.map((_, at) => rows.map((point) => point.acceleration_spectrum_m_s2[at]));
      const title = ["Waterfall: circumferential acceleration, m/s²", branch].filter(Boolean).join(", ");
      pictures.push({ label: title, show: () => draw(byId("sweep-plot"), [heatMap(values, orders, grid, "m/s²")], { x, y: "mesh order", title }) });
    }
  }
  for (const diagram of campbell ?? []) {
    const speeds = diagram.pinion_speed_rpm;
    const modes = diagram.natural_modes.filter((mode) => mode.frequency_hz > 0);
    const top = 1.1 * Math.max(...modes.map((mode) => mode.frequency_hz));
    const ordersBelow = diagram.mesh_orders.filter((order) => order * diagram.mesh_frequency_hz[0] < top);
    const cut = (order) => Math.min(1, top / (order * diagram.mesh_frequency_hz[1]));
    const traces = [
      ...ordersBelow.map((order) => {
        const ends = [0, cut(order)];
        return line(ends.map((end) => end * speeds[1]), ends.map((end) => end * order * diagram.mesh_frequency_hz[1]), `order ${order}`);
      }),
      ...modes.map((mode) => line([0, speeds[1]], [mode.frequency_hz, mode.frequency_hz], mode.name)),
      dots(diagram.crossings.map((crossing) => crossing.pinion_speed_rpm), diagram.crossings.map((crossing) => crossing.frequency_hz), "crossings"),
    ];
    pictures.push({ label: "Campbell diagram", show: () => draw(byId("sweep-plot"), traces, { x: "Pinion speed, r/min", y: "Hz" }) });
  }
  return pictures;
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
