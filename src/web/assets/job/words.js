// Names and explanations of regimes, contact, methods and channels.

import { number } from "../common/format.js";

/** Regime of the motion: name and sentence. @param {ResponseResult} response @returns {[string, string]} */
export function regimeWords({ regime, period_mesh_periods: periods, lyapunov_per_mesh_period: lyapunov }) {
  if (regime === "period-1") return ["Period 1", "The motion repeats every mesh period: its spectrum has mesh orders only."];
  if (periods && periods > 1) return [`Period ${periods}`, `The motion repeats every ${periods} mesh periods: subharmonics at multiples of 1/${periods} of the mesh frequency.`];
  if (regime === "quasi-periodic") return ["Quasi-periodic", "The motion never repeats exactly: it holds frequencies that are no fractions of the mesh frequency."];
  if (regime === "chaotic") return ["Chaotic", `The motion never repeats: small differences grow (Lyapunov exponent ${number(lyapunov, 3)} per mesh period). Its numbers are means over the record.`];
  if (regime === "not-settled") return ["Not settled", "The record ended before the motion had settled: its numbers are those of this record, not of a steady state."];
  if (regime === "unstable") return ["Unstable", `The vibration grows without bound, by a factor of ${number(Math.exp(lyapunov ?? 0), 4)} per mesh period: its numbers mean nothing.`];
  return [sentenceOf(regime), ""];
}

/**
 * Contact state: name and sentence; `table` is the mesh's contact force, where the equations contain that.
 * @param {ResponseResult} response
 * @param {MeshResult["contact_force"]} [table]
 * @returns {[string, string]}
 */
export function contactWords({ contact, contact_share: share, fraction_in_contact: fraction }, table) {
  const touching = share ? Math.min(share.left, share.right) : fraction;
  const apart = number(100 * (1 - touching), 3);
  if (contact === "continuous") return ["Teeth stay in contact", table ? "The working flanks never separate completely." : "The working flanks never separate: the system is linear with periodic stiffness."];
  if (contact === "single-sided") return ["Teeth separate", `The working flanks leave each other for ${apart} % of the time and meet again: rattling on one side of the gap.`];
  if (contact === "double-sided") return ["Teeth hit both flanks", `The teeth cross the whole backlash and hit the back flanks as well; they are free for ${apart} % of the time.`];
  if (contact === "apart") return ["Teeth do not touch", "Without load the teeth stay in the middle of their backlash."];
  return [sentenceOf(contact), ""];
}

/** @param {string} word */
const sentenceOf = (word) => (word ? `${word.charAt(0).toUpperCase()}${word.slice(1).replaceAll("_", " ")}` : "");

export const METHODS = { periodic: "periodic solution, solved for directly", integrate: "integrated in time", "integrate (event-exact)": "integrated in time" };
export const STIFFNESS = { ltca: "loaded tooth contact analysis", iso6336: "ISO 6336-1, method B", given: "given" };
/** Motions that an impact acts on. */
export const ACTS_ON = { torsion: "rotations only (the source's law)", all: "rotations, bending and axial motion" };
export const IMPACTS = { corner_contact: "corner contact, buffered by the pairs in mesh", zhou2008: "Zhou 2008, unbuffered", given: "given", none: "none" };

const SOURCES = {
  x: "mesh, along the circumference (x)", s: "mesh, normal to the teeth (s)",
  y_p: "pinion, lateral (y)", z_p: "pinion, axial (z)", theta_p: "pinion, rotation (θ)",
  y_g: "gear, lateral (y)", z_g: "gear, axial (z)", theta_g: "gear, rotation (θ)",
  f_n: "mesh force, normal", f_y: "mesh force, tangential", f_z: "mesh force, axial",
  tooth_force: "tooth force, normal, impact included",
};

/** A channel's name as words: "mesh, along the circumference (x), left". @param {string} name */
export function channelWords(name) {
  const [, source, half] = /^(?:[va]_)?(.+)_(left|right)$/.exec(name) ?? [];
  return SOURCES[source] ? `${SOURCES[source]}, ${half}` : name;
}

/**
 * Unit in which a channel is shown, and the factor of its values: micrometres rather than metres.
 * @param {string} unit
 */
export function channelScale(unit) {
  /** @type {Record<string, [string, number]>} */
  const scales = { m: ["µm", 1e6], "m/s": ["mm/s", 1e3], "m/s2": ["m/s²", 1], rad: ["µrad", 1e6], "rad/s2": ["rad/s²", 1] };
  const [shown, factor] = scales[unit] ?? [unit, 1];
  return { unit: shown, factor };
}
