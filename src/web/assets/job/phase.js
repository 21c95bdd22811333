// The phase plane of the meshes, with the motion at the starts of mesh periods.

import * as api from "../common/api.js";
import { byId, notify, show } from "../common/dom.js";
import { number } from "../common/format.js";
import { draw } from "../common/plots.js";
import { remember, told } from "./address.js";
import { halvesAlike, phasePlot } from "./motion_plots.js";

/** Most points of a path: its two channels have to be complete over the time shown. */
const MAX_POINTS = 20_000;
const PLANES = { x: "Displacement along the circumference x, µm", s: "Displacement normal to the teeth s, µm" };

/** @param {JobContext} context */
export async function showPhase({ id, result: { response, numerics }, input, catalogue }) {
  if (!response) return;
  const known = new Map(catalogue.map((channel) => [channel.name, channel]));
  const planes = Object.keys(PLANES).filter((plane) => known.has(`${plane}_left`) && known.has(`v_${plane}_left`));
  if (!planes.length) return;
  show(byId("phase"));
  const choice = byId("phase-plane");
  for (const option of Array.from(choice.options)) if (!planes.includes(option.value)) option.remove();
  // With half of the equations solved the halves mirror each other.
  const halves = ["left", "right"].filter((half) => half === "left" || (!halvesAlike(numerics) && known.has(`x_${half}`)));
  const update = async () => {
    const plane = choice.value;
    const paths = await Promise.all(halves.flatMap((half) => {
      const channel = known.get(`${plane}_${half}`);
      return channel ? [path(id, response, channel, plane, half)] : [];
    }));
    const backlash = response.backlash_um ?? input?.design?.backlash_um;
    const edge = plane === "s" && typeof backlash === "number" ? backlash / 2 : null;
    const { traces, axes } = phasePlot(paths, { x: PLANES[plane], y: "Velocity, mm/s", edge });
    await draw(byId("phase-plot"), traces, axes);
    const [{ place, dots }] = paths;
    byId("phase-note").textContent = `${number(place.length)} samples${halves.length === 1 ? "; left and right are alike" : ""}${dots.place.length ? `; ${number(dots.place.length)} ${dots.place.length === 1 ? "point" : "points"}, one per mesh period` : ""}.`;
  };
  const named = told().get("plane");
  if (named && planes.includes(named)) choice.value = named;
  choice.addEventListener("change", () => {
    remember({ plane: choice.value });
    update().catch((error) => notify(byId("notice"), error));
  });
  await update();
}

/**
 * The path of one half in µm and mm/s, and its points once per mesh period.
 * @param {string} id
 * @param {ResponseResult} response
 * @param {SeriesChannel} channel
 * @param {string} plane
 * @param {string} half
 */
async function path(id, response, { t0, t_end: end, n, dt }, plane, half) {
  const from = n > MAX_POINTS ? end - MAX_POINTS * dt : t0;
  const names = [`${plane}_${half}`, `v_${plane}_${half}`];
  const [x, v] = await Promise.all(names.map((name) => api.series(id, name, { from, to: end, method: "none" })));
  const [micrometres, millimetres] = [valuesOf(x, 1e6), valuesOf(v, 1e3)];
  const { x_left_m: px = [], v_x_left_m_s: pv = [] } = response.poincare;
  const told = plane === "x" && half === "left" && px.length > 0;
  const dots = told ? { place: px.map((value) => value * 1e6), velocity: pv.map((value) => value * 1e3) } : oncePerPeriod(response, x.t, dt, t0, micrometres, millimetres);
  // A periodic record ends one sample before it begins again.
  /** @param {number[]} values */
  const closed = (values) => (response.method === "periodic" ? [...values, values[0]] : values);
  return { half, place: closed(micrometres), velocity: closed(millimetres), dots };
}

/**
 * Values of a series times a factor; values that are not finite become 0.
 * @param {SeriesData} series
 * @param {number} factor
 */
const valuesOf = ({ y }, factor) => y.map((value) => (value ?? 0) * factor);

/**
 * The samples at the starts of mesh periods.
 * @param {ResponseResult} response
 * @param {number[]} times
 * @param {number} dt
 * @param {number} t0
 * @param {number[]} place
 * @param {number[]} velocity
 */
function oncePerPeriod(response, times, dt, t0, place, velocity) {
  const every = Math.round(1 / (response.mesh_frequency_hz * dt));
  const chosen = times.map((time, index) => [Math.round((time - t0) / dt), index]).filter(([sample]) => sample % every === 0).map(([, index]) => index);
  return { place: chosen.map((index) => place[index]), velocity: chosen.map((index) => velocity[index]) };
}
