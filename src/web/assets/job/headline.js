// The headline numbers of a result, each with its meaning.

import { byId, el, show, tip } from "../common/dom.js";
import { number } from "../common/format.js";
import { scalarAt } from "../common/scalars.js";
import { nearestResonance } from "./motion_plots.js";
import { nameOfBearing } from "./shafts_plots.js";
import { IMPACTS, STIFFNESS, contactWords, regimeWords } from "./words.js";

/** Standard gravity, m/s². */
const GRAVITY = 9.80665;

/**
 * Name, number, unit, note and explanation of each headline; those without a value in the result are left out.
 * @param {JobResult} result
 */
export function headlines({ geometry, mesh, shafts, impact, response, numerics, accuracy }) {
  /** @type {[name: string, shown: string, unit: string, note: Child | Child[], meaning: Explained][]} */
  const tiles = [];
  /** @param {typeof tiles[number]} tile */
  const add = (...tile) => tiles.push(tile);
  /** The tile of a scalar. @param {string} pointer @param {string} shown @param {Child | Child[]} note */
  const addScalar = (pointer, shown, note) => {
    const scalar = scalarAt(pointer);
    add(scalar.label, shown, scalar.unit, note, scalar);
  };
  if (response) {
    const { rms } = response;
    const [contact, contactNote] = contactWords(response, mesh?.contact_force);
    const [regime, regimeNote] = regimeWords(response);
    addScalar("/response/contact", contact, contactNote);
    addScalar("/response/regime", regime, regimeNote);
    if (typeof response.dynamic_factor === "number") addScalar("/response/dynamic_factor", number(response.dynamic_factor, 4), "largest tooth force over the static one");
    addScalar("/response/rms/mesh_circumferential_acceleration_m_s2/{half}", pair(rms.mesh_circumferential_acceleration_m_s2), sidesNote(rms.mesh_circumferential_acceleration_m_s2));
    addScalar("/response/rms/pinion_axial_acceleration_m_s2/{half}", pair(rms.pinion_axial_acceleration_m_s2), sidesNote(rms.pinion_axial_acceleration_m_s2));
  }
  if (shafts) {
    const { left, right, iso6336: iso } = shafts;
    addScalar("/shafts/{half}/k_h_beta_5mm", pair({ left: left.k_h_beta_5mm, right: right.k_h_beta_5mm }), ["left / right", iso ? `; ISO 6336-1 ${number(iso.k_h_beta, 3)} (${iso.half})` : ""].join(""));
  }
  if (typeof response?.largest_bearing_force_rms_n === "number") addScalar("/response/largest_bearing_force_rms_n", number(response.largest_bearing_force_rms_n, 4), bearingNote(response));
  if (impact) addScalar("/impact/force_n", number(impact.force_n, 4), impactNote(impact));
  if (mesh) {
    const { transmission_error_pp_um: span, transmission_error_mean_um: mean } = mesh;
    addScalar("/mesh/transmission_error_pp_um", number(span, 3), mean ? `${number((100 * span) / mean, 3)} % of the mean of ${number(mean, 3)} µm` : "");
  }
  if (geometry) {
    const loaded = mesh?.loaded_contact_ratio;
    const parts = ["ε", el("sub", {}, "α"), ` ${number(geometry.transverse_contact_ratio, 4)} + ε`, el("sub", {}, "β"), ` ${number(geometry.overlap_ratio, 4)}`, loaded ? `; loaded ${number(loaded, 4)}` : ""];
    addScalar("/geometry/total_contact_ratio", number(geometry.total_contact_ratio, 4), parts);
  }
  if (mesh) {
    const { stiffness_mean_n_per_um: mean, stiffness_min_n_per_um: low, stiffness_max_n_per_um: high } = mesh;
    addScalar("/mesh/stiffness_mean_n_per_um", number(mean, 4), `${number(low, 4)} to ${number(high, 4)}, ${STIFFNESS[mesh.source] ?? mesh.source}`);
  }
  const nearest = response && nearestResonance(response, numerics);
  if (nearest) {
    const { order, ratio, mode } = nearest;
    add("Nearest resonance", number(ratio, 3), "", `order ${order} at ${number(ratio, 3)} of mode ${mode.index} (${number(mode.frequency_hz, 4)} Hz)`, { help: "The mesh order that lies closest to a natural frequency which the mesh excites: the order's frequency over the natural frequency. Close to 1 the vibration grows until damping holds it.", theory: "vibration#natural-frequencies-and-modes" });
  }
  if (accuracy) add("Error of the model", ...accuracyTexts(accuracy));
  return tiles;
}

/**
 * Number, unit, note and explanation of the error of the model, with the numerical error beside it.
 * @param {Accuracy} accuracy
 * @returns {[shown: string, unit: string, note: string, meaning: Explained]}
 */
export function accuracyTexts({ numerical, model }) {
  const { mesh_stiffness_percent: stiffness, transmission_error_harmonic_percent: harmonic, basis } = model;
  const claims = typeof stiffness === "number";
  const solved = typeof numerical === "number" ? `numerical error ${number(numerical, 2)}` : "";
  const notes = [claims ? `of the mesh stiffness; ${number(harmonic, 2)} % of the transmission error's first harmonic` : "the mesh stiffness is given", solved];
  return [
    claims ? number(stiffness, 2) : "Not known", claims ? "%" : "", notes.filter(Boolean).join("; "),
    {
      help: `${scalarAt("/accuracy/numerical").help} ${scalarAt("/accuracy/model/mesh_stiffness_percent").help} Basis: ${basis}.`,
      theory: scalarAt("/accuracy/model/mesh_stiffness_percent").theory,
    },
  ];
}

/** @param {JobResult} result */
export function showHeadline(result) {
  const tiles = headlines(result);
  const box = byId("headline");
  box.replaceChildren(
    ...tiles.map(([name, shown, unit, note, meaning]) =>
      el(
        "div",
        { class: "tile" },
        el("div", { class: "tile-head" }, el("span", { class: "name" }, name), tip(name, meaning)),
        el("span", { class: /^[A-Z]/.test(shown) ? "number words" : "number" }, shown, unit ? el("span", { class: "unit" }, ` ${unit}`) : null),
        el("span", { class: "note" }, ...[note].flat()),
      ),
    ),
  );
  show(box, tiles.length > 0);
}

/** The bearing with the largest amplitude of any order. @param {ResponseResult} response */
function bearingNote({ bearings = [] }) {
  const strongest = bearings.flatMap((bearing) => /** @type {const} */ (["x", "y", "z"]).flatMap((axis) => bearing.force_n[axis].amplitudes.map((amplitude, at) => ({ bearing, axis, amplitude, order: at + 1 }))));
  if (!strongest.length) return "";
  const { bearing, axis, amplitude, order } = strongest.reduce((most, one) => (one.amplitude > most.amplitude ? one : most));
  return `strongest: order ${order} of ${nameOfBearing(bearing)}, ${axis}, ${number(amplitude, 3)} N`;
}

/** @param {ImpactResult} impact */
function impactNote({ force_n: force, source, applied, zhou2008_force_n: zhou, reduction_percent: reduction }) {
  if (applied === false) return "only reported: the mesh force in the equations already holds it";
  if (force === 0) return "no early contact: the teeth enter without a blow";
  if (typeof zhou !== "number" || zhou <= 0) return IMPACTS[source] ?? source ?? "";
  const used = source === "zhou2008" ? "; Zhou's excites the response" : "";
  return `${number(reduction, 3)} % below Zhou 2008 (${number(zhou, 4)} N)${used}`;
}

/** @param {PerHalf} sides */
const alike = ({ left, right }) => Math.abs(left - right) <= 1e-9 * Math.max(Math.abs(left), Math.abs(right));
/** One number where both halves have the same. @param {PerHalf} sides */
const pair = (sides) => (alike(sides) ? number(sides.left, 4) : `${number(sides.left, 4)} / ${number(sides.right, 4)}`);
/** @param {PerHalf} sides */
const sidesNote = (sides) => {
  const most = number(Math.max(sides.left, sides.right) / GRAVITY, 3);
  return alike(sides) ? `each half, left and right alike; ${most} g` : `left / right; at most ${most} g`;
};
