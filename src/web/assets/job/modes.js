// Natural frequencies against the harmonics of the mesh frequency.

import { byId, el, fillRows, show } from "../common/dom.js";
import { number } from "../common/format.js";
import { draw } from "../common/plots.js";
import { meshShare, modesPlot, nearestOrder, nearestResonance } from "./motion_plots.js";

/** @param {JobContext} context */
export async function showModes({ result: { response, numerics }, input }) {
  if (!response) return;
  const picture = modesPlot(response, numerics);
  if (!picture) return;
  show(byId("modes"));
  const nearest = nearestResonance(response, numerics);
  byId("modes-note").replaceChildren(
    ...(nearest
      ? [`Nearest resonance: `, el("strong", {}, `order ${nearest.order} at ${number(nearest.ratio, 3)} of mode ${nearest.mode.index}`), ` (${nearest.mode.name}, ${number(nearest.mode.frequency_hz, 4)} Hz).`]
      : ["No mode has a noticeable part of its strain energy in the meshes."]),
    " Undamped, contact closed, mean mesh stiffness.",
  );
  fillRows(byId("modes-table").tBodies[0], modeRows(response, input));
  await draw(byId("modes-plot"), picture.traces, picture.axes);
}

/**
 * Number, frequency, damping, share of the meshes, nearest order, its ratio, speed of the resonance and name of each
 * mode.
 * @param {ResponseResult} response
 * @param {JobInput} input
 * @returns {string[][]}
 */
export function modeRows({ natural_modes: modes = [], mesh_frequency_hz: mesh }, input) {
  const speed = input?.operation?.pinion_speed_rpm;
  return modes.map((mode, at) => {
    const nearest = nearestOrder(mode.frequency_hz, mesh);
    return [
      String(at + 1),
      mode.frequency_hz > 0 ? number(mode.frequency_hz, 5) : "0",
      typeof mode.damping_ratio === "number" ? number(100 * mode.damping_ratio, 3) : "",
      mode.frequency_hz > 0 ? number(meshShare(mode) < 1e-9 ? 0 : 100 * meshShare(mode), 3) : "",
      nearest ? String(nearest.order) : "",
      nearest ? number(nearest.ratio, 3) : "",
      nearest && speed > 0 ? number(speed / nearest.ratio, 4) : "",
      mode.name,
    ];
  });
}
