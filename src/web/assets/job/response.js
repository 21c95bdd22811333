// RMS tables and what the response is like.

import { byId, fillRows, fillValues, show } from "../common/dom.js";
import { number, sentence, shownUnit } from "../common/format.js";
import { channelWords, contactWords, regimeWords } from "./words.js";

/** @param {JobContext} context */
export function showResponse({ result: { response }, catalogue, input }) {
  if (!response) return;
  const { rms, confidence_interval_95: intervals } = response;
  /** @param {{ low?: number | null, high?: number | null }} [interval] */
  const unsure = ({ low, high } = {}) => (typeof low === "number" ? ` (${number(low, 4)} to ${number(high, 4)})` : "");
  /**
   * @param {string} name
   * @param {"mesh_circumferential_acceleration_m_s2" | "pinion_axial_acceleration_m_s2"} quantity
   */
  const row = (name, quantity) => [name, .../** @type {const} */ (["left", "right"]).map((half) => number(rms[quantity]?.[half]) + unsure(intervals?.[quantity]?.[half])), "m/s²"];
  fillRows(byId("rms").tBodies[0], [row("Circumferential, mesh", "mesh_circumferential_acceleration_m_s2"), row("Axial, pinion", "pinion_axial_acceleration_m_s2")]);
  byId("rms-note").textContent = intervals ? "In brackets: where the true values lie with 95 % probability; the motion does not repeat, and the record is finite." : "";
  fillValues(byId("response-values"), responseValues(response, input));
  const known = new Map(catalogue.map((channel) => [channel.name, channel]));
  fillRows(byId("channels-rms").tBodies[0], Object.entries(rms.channels ?? {}).map(([name, value]) => {
    const channel = known.get(name);
    return [name, sentence(channelWords(name)), number(value), shownUnit(channel?.unit)];
  }));
  show(byId("response"));
}

/**
 * Normal force on the teeth, impact included: one row for each half, or one for both where they are alike.
 * @param {ResponseResult["tooth_force_n"]} forces
 * @returns {ValueRow[]}
 */
function toothForces(forces) {
  if (!forces) return [];
  /** @type {(name: string, force: NonNullable<typeof forces>["left"]) => ValueRow} */
  const row = (name, { static: still, max, min }) => [name, `${number(min, 4)} to ${number(max, 4)} (static ${number(still, 4)})`, "N"];
  const { left, right } = forces;
  const alike = ["static", "max", "min"].every((key) => Math.abs(left[key] - right[key]) <= 1e-9 * Math.abs(left.max));
  return alike ? [row("Tooth force, each half", left)] : [row("Tooth force, left", left), row("Tooth force, right", right)];
}

/** @param {ResponseResult} response @param {JobInput} input @returns {ValueRow[]} */
export function responseValues(response, input) {
  /** @param {number | null | undefined} shown */
  const value = (shown, digits = 4) => (typeof shown === "number" ? number(shown, digits) : null);
  const share = response.contact_share;
  const gap = response.backlash_um ?? input?.design?.backlash_um;
  return [
    ["Motion", regimeWords(response)[0]],
    ["Contact", contactWords(response)[0]],
    ["Dynamic factor", value(response.dynamic_factor, 5)],
    ...toothForces(response.tooth_force_n),
    ["Least displacement s", value(response.min_displacement_um), "µm"],
    ["Flanks touch from s = b on", typeof gap === "number" ? number(gap / 2, 4) : null, "µm"],
    ["In contact, left / right", share ? `${number(100 * share.left, 4)} / ${number(100 * share.right, 4)}` : null, "% of time"],
    ["Mesh frequency", value(response.mesh_frequency_hz, 5), "Hz"],
    ["Repeats after", response.period_mesh_periods ? number(response.period_mesh_periods) : null, response.period_mesh_periods === 1 ? "mesh period" : "mesh periods"],
    ["Largest Floquet multiplier", value(response.floquet_modulus_per_mesh_period), "per mesh period"],
    ["Lyapunov exponent", value(response.lyapunov_per_mesh_period, 3), "per mesh period"],
    ["Plane of the equations", response.plane],
    ["Mesh damper in the gap", response.damping_in_gap ? "acts (the source's law)" : "does not act"],
  ];
}
