// Forces in the bearings: mean, RMS and mesh orders.

import { byAnyId, byId, el, fillRows, show } from "../common/dom.js";
import { number, sentence } from "../common/format.js";
import { draw } from "../common/plots.js";
import { bearingOrdersPlot, movedAxes, nameOfBearing } from "./shafts_plots.js";

/** Mesh orders of the table. */
const ORDERS = 10;
const AXES = /** @type {const} */ (["x", "y", "z"]);

/** @param {JobContext} context */
export async function showBearings({ id, result: { response } }) {
  if (!response?.bearings?.length) return;
  show(byId("bearings"));
  byId("bearings-csv").href = `/api/v1/jobs/${id}/bearing-forces`;
  byId("bearings-csv").download = `bearing-forces-${id}.csv`;
  byId("bearings-table").tHead?.replaceChildren(el("tr", {}, ...["Bearing", "Position, mm", "Axis", "Mean, N", "RMS, N", ...orders().map((order) => `Order ${order}, N`)].map((name) => el("th", { scope: "col" }, name))));
  fillRows(byId("bearings-table").tBodies[0], bearingRows(response));
  const moved = movedAxes(response);
  const choices = AXES.map((axis) => /** @type {HTMLInputElement} */ (byAnyId(`bearing-axis-${axis}`)));
  choices.forEach((choice, index) => {
    choice.disabled = !moved.includes(AXES[index]);
    choice.checked = AXES[index] === (moved.includes("y") ? "y" : moved[0]);
    choice.addEventListener("change", update);
  });
  byId("bearing-log").addEventListener("change", update);
  show(byId("bearings-figure"), moved.length > 0);
  await update();

  async function update() {
    const axis = AXES[choices.findIndex((choice) => choice.checked)];
    const picture = axis && bearingOrdersPlot(response, axis);
    if (picture) await draw(byId("bearings-plot"), picture.traces, { ...picture.axes, log: byId("bearing-log").checked });
  }
}

const orders = () => Array.from({ length: ORDERS }, (_, index) => index + 1);

/**
 * A row for each bearing and axis along which it carries anything: name, position, axis, mean, RMS, orders.
 * @param {ResponseResult} response
 * @returns {string[][]}
 */
export function bearingRows({ bearings = [] }) {
  return bearings.flatMap((bearing) => AXES.flatMap((axis) => {
    const { mean, rms, amplitudes } = bearing.force_n[axis];
    if (Math.abs(mean) < 1e-6 && !(rms > 1e-6)) return [];
    return [[sentence(nameOfBearing(bearing)), number(bearing.position_mm, 4), axis, number(Math.abs(mean) < 1e-6 ? 0 : mean, 4), number(rms, 3), ...orders().map((order) => (order <= amplitudes.length ? number(amplitudes[order - 1], 3) : ""))]];
  }));
}
