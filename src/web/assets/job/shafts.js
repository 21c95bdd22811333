// Both halves on their shafts: drawing with deflections and bearing forces, load along the faces, helix modifications.

import * as api from "../common/api.js";
import { byAnyId, byId, fillRows, fillValues, show, showFigureOf } from "../common/dom.js";
import { number, sentence } from "../common/format.js";
import { draw } from "../common/plots.js";
import { rowsFrom, scalarAt } from "../common/scalars.js";
import { drawDeflection } from "./shafts_drawing.js";
import { MEMBERS, deflectionPlot, faceLoadPlot, torquePlot, twistPlot } from "./shafts_plots.js";

/**
 * The shafts of a document to scale; null where this version refuses an older one.
 * @param {JobInput} input
 */
export async function shaftsDrawingOf(input) {
  try {
    const { drawing } = await api.validate(input, { drawing: true });
    return drawing?.shafts ?? null;
  } catch (error) {
    if (error instanceof api.Problem && error.status === 422) return null;
    throw error;
  }
}

/** @param {JobContext} context @param {import("./shafts_plots.js").ShaftsDrawing | null} drawing */
export async function showShafts({ result: { shafts }, input, gearData }, drawing) {
  if (!shafts) return;
  show(byId("shafts"));
  show(byId("deflection"), Boolean(drawing));
  if (drawing) {
    const factor = drawDeflection(byId("deflection-drawing"), drawing, shafts);
    byId("deflection-factor").textContent = `magnified ${number(factor)} times`;
  }
  fillRows(byId("reactions").tBodies[0], reactionRows(shafts));
  fillValues(byId("shafts-values"), shaftsValues(shafts));
  const friction = frictionRows(shafts);
  show(byId("friction-box"), friction.length > 0);
  fillRows(byId("friction").tBodies[0], friction);
  await Promise.all([
    plot("face-load-plot", faceLoadPlot(shafts, gearData)),
    plot("torque-plot", torquePlot(shafts, input?.operation?.pinion_torque_nm)),
    plot("deflection-plot", deflectionPlot(shafts, drawing)),
    plot("twist-plot", twistPlot(shafts, drawing)),
  ]);
}

/** Forces and moments of the bearings on the shafts. @param {ShaftsResult} shafts @returns {string[][]} */
export function reactionRows(shafts) {
  return MEMBERS.flatMap((member) => shafts[member].bearings.map(({ position_mm: position, force_on_shaft_n: force, moment_on_shaft_nm: moment }, index) => [
    `${sentence(member)}, bearing ${index + 1}`, number(position, 4), ...[...force, ...moment].map((value) => number(rounded(value, [...force, ...moment]), 4)),
  ]));
}

/** Rounding errors beside the other components are zero. @param {number} value @param {number[]} among */
const rounded = (value, among) => (Math.abs(value) <= 1e-9 * Math.max(1, ...among.map(Math.abs)) ? 0 : value);

/** @param {ShaftsResult} shafts @returns {ValueRow[]} */
export function shaftsValues(shafts) {
  const row = rowsFrom({ shafts });
  const { iso6336: iso } = shafts;
  return [
    row("/shafts/{half}/k_h_beta", 4),
    row("/shafts/{half}/k_h_beta_5mm", 4),
    ["Face load factor by ISO 6336-1", iso ? `${number(iso.k_h_beta, 4)} (${iso.half} half, f_sh ${number(iso.f_sh_um, 3)} µm, K' ${number(iso.k_prime, 3)})` : null, "", scalarAt("/shafts/iso6336/k_h_beta")],
    row("/shafts/iso6336/basis"),
    row("/shafts/k_gamma"),
    row("/shafts/{half}/share", 4),
    row("/shafts/{half}/helix_modification/slope_um", 3),
    row("/shafts/{half}/helix_modification/crowning_um", 3),
    row("/shafts/{half}/helix_modification/k_h_beta_5mm", 4),
    row("/shafts/line_load_mean_n_per_mm", 4),
    row("/shafts/{half}/line_load_inner_end_n_per_mm", 4),
    row("/shafts/{half}/line_load_outer_end_n_per_mm", 4),
    row("/shafts/{half}/normal_force_mean_n"),
    row("/shafts/{half}/axial_force_on_pinion_n", 4),
    row("/shafts/transmission_error/between_couplings_mean_um"),
    row("/shafts/transmission_error/between_couplings_pp_um", 4),
    ["Transmission error between the couplings, harmonics 1 to 3", shafts.transmission_error.harmonics_um.map((value) => number(value, 3)).join(", "), "µm", scalarAt("/shafts/transmission_error/harmonics_um/0")],
    row("/shafts/{half}/approach_mid_face_mean_um", 4),
    ["Axial displacement of the pinion, mean", number(shafts.pinion_axial_float_um.mean, 3), "µm", scalarAt("/shafts/pinion_axial_float_um/mean")],
    rowsFrom({ shafts: { open_fraction: rounded(shafts.open_fraction, []) } })("/shafts/open_fraction", 3),
  ];
}

/**
 * What friction in the pinion's coupling can do: both limits of the axial balance.
 * @param {ShaftsResult} shafts
 * @returns {string[][]}
 */
export function frictionRows({ axial_friction: friction }) {
  if (!friction) return [];
  return [["Coupling pushes to the left", friction.pushed_left], ["Coupling pushes to the right", friction.pushed_right]].map(([name, limit]) => {
    const { share, k_gamma: gamma, pinion_axial_float_um: float, k_h_beta: beta } = /** @type {typeof friction.pushed_left} */ (limit);
    return [String(name), number(friction.force_n, 4), ...[100 * share.left, 100 * share.right, gamma, float, beta.left, beta.right].map((value) => number(value, 4))];
  });
}

/** @param {string} id @param {Plot | null} picture */
async function plot(id, picture) {
  const box = byAnyId(id);
  showFigureOf(box, Boolean(picture));
  if (picture) await draw(box, picture.traces, picture.axes);
}
