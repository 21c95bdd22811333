// RMS tables, and the character of the response.

import { byId, fillRows, fillValues, show, theoryLink } from "../common/dom.js";
import { number, sentence, shownUnit } from "../common/format.js";
import { rowsFrom, scalarAt } from "../common/scalars.js";
import { channelWords, contactWords, regimeWords } from "./words.js";

/** @param {JobContext} context */
export function showResponse({ result: { response }, catalogue, input }) {
  if (!response) return;
  const { rms, confidence_interval_95: intervals } = response;
  /** @param {{ low?: number | null, high?: number | null }} [interval] */
  const unsure = ({ low, high } = {}) => (typeof low === "number" ? ` (${number(low, 4)} to ${number(high, 4)})` : "");
  /** @param {"mesh_circumferential_acceleration_m_s2" | "pinion_axial_acceleration_m_s2"} quantity */
  const row = (quantity) => [theoryLink(scalarAt(`/response/rms/${quantity}/{half}`)), .../** @type {const} */ (["left", "right"]).map((half) => number(rms[quantity]?.[half]) + unsure(intervals?.[quantity]?.[half])), scalarAt(`/response/rms/${quantity}/{half}`).unit];
  fillRows(byId("rms").tBodies[0], [row("mesh_circumferential_acceleration_m_s2"), row("pinion_axial_acceleration_m_s2")]);
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
  const row = (name, { static: still, max, min }) => [name, `${number(min, 4)} to ${number(max, 4)} (static ${number(still, 4)})`, scalarAt("/response/tooth_force_n/{half}/max").unit, scalarAt("/response/tooth_force_n/{half}/max")];
  const { left, right } = forces;
  const alike = ["static", "max", "min"].every((key) => Math.abs(left[key] - right[key]) <= 1e-9 * Math.abs(left.max));
  return alike ? [row("Tooth force, each half", left)] : [row("Tooth force, left", left), row("Tooth force, right", right)];
}

/** @param {ResponseResult} response @param {JobInput} input @returns {ValueRow[]} */
export function responseValues(response, input) {
  const row = rowsFrom({ response });
  const gap = response.backlash_um ?? input?.design?.backlash_um;
  return [
    [scalarAt("/response/regime").label, regimeWords(response)[0], "", scalarAt("/response/regime")],
    [scalarAt("/response/contact").label, contactWords(response)[0], "", scalarAt("/response/contact")],
    row("/response/dynamic_factor"),
    ...toothForces(response.tooth_force_n),
    row("/response/min_displacement_um", 4),
    ["Flanks touch from s = b on", typeof gap === "number" ? number(gap / 2, 4) : null, scalarAt("/response/backlash_um").unit, scalarAt("/response/backlash_um")],
    row("/response/contact_share/{half}", 4),
    row("/response/mesh_frequency_hz"),
    row("/response/period_mesh_periods"),
    row("/response/floquet_modulus_per_mesh_period", 4),
    row("/response/lyapunov_per_mesh_period", 3),
    row("/response/plane"),
    [scalarAt("/response/damping_in_gap").label, response.damping_in_gap ? "yes (the source's law)" : "no", "", scalarAt("/response/damping_in_gap")],
  ];
}
