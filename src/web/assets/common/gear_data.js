// Gear data as tables: names and symbols of ISO 21771-1 for the members of the API's answer.

import * as api from "./api.js";
import { el } from "./dom.js";

/**
 * The gear data of a job; null where this version refuses the pair of an older one.
 * @param {string} id
 */
export async function gearDataOf(id) {
  try {
    return await api.gearData(id);
  } catch (error) {
    if (error instanceof api.Problem && error.status === 422) return null;
    throw error;
  }
}

/**
 * A member of the answer: its symbol (letter and index), name and unit.
 * @template Key
 * @typedef {[key: Key, letter: string, index: string, name: string, unit: string]} Entry
 */

/** @type {Entry<Exclude<keyof GearData, "pinion" | "gear" | "path_points" | "contact_lines">>[]} */
const PAIR = [
  ["normal_module_mm", "m", "n", "Normal module", "mm"],
  ["transverse_module_mm", "m", "t", "Transverse module", "mm"],
  ["normal_pressure_angle_deg", "α", "n", "Normal pressure angle", "°"],
  ["transverse_pressure_angle_deg", "α", "t", "Transverse pressure angle", "°"],
  ["working_pressure_angle_deg", "α", "wt", "Working transverse pressure angle", "°"],
  ["helix_angle_deg", "β", "", "Helix angle", "°"],
  ["base_helix_angle_deg", "β", "b", "Base helix angle", "°"],
  ["gear_ratio", "u", "", "Gear ratio", ""],
  ["center_distance_mm", "a", "", "Centre distance, working", "mm"],
  ["face_width_mm", "b", "", "Face width of a half", "mm"],
  ["gap_width_mm", "", "", "Gap between the halves", "mm"],
  ["transverse_base_pitch_mm", "p", "bt", "Transverse base pitch", "mm"],
  ["axial_pitch_mm", "p", "x", "Axial pitch", "mm"],
  ["path_of_contact_mm", "g", "α", "Length of the path of contact", "mm"],
  ["transverse_contact_ratio", "ε", "α", "Transverse contact ratio", ""],
  ["overlap_ratio", "ε", "β", "Overlap ratio", ""],
  ["total_contact_ratio", "ε", "γ", "Total contact ratio", ""],
  ["backlash_um", "j", "", "Backlash along s, total", "µm"],
  ["pitch_line_velocity_m_s", "v", "w", "Pitch line velocity", "m/s"],
];

/** @type {Entry<keyof GearData["pinion"]>[]} */
const MEMBERS = [
  ["teeth", "z", "", "Number of teeth", ""],
  ["left_half_hand", "", "", "Hand of the left half", ""],
  ["profile_shift", "x", "", "Profile shift coefficient", ""],
  ["reference_diameter_mm", "d", "", "Reference diameter", "mm"],
  ["base_diameter_mm", "d", "b", "Base diameter", "mm"],
  ["working_pitch_diameter_mm", "d", "w", "Working pitch diameter", "mm"],
  ["tip_diameter_mm", "d", "a", "Tip diameter", "mm"],
  ["root_diameter_mm", "d", "f", "Root diameter", "mm"],
  ["root_form_diameter_mm", "d", "Ff", "Root form diameter", "mm"],
  ["tip_thickness_normal_mm", "s", "an", "Normal tooth thickness at the tip", "mm"],
  ["addendum", "h*", "aP", "Addendum of the rack, modules", ""],
  ["dedendum", "h*", "fP", "Dedendum of the rack, modules", ""],
  ["fillet_radius", "ρ*", "fP", "Root fillet radius of the rack, modules", ""],
  ["face_width_mm", "b", "", "Face width of a half of its own", "mm"],
  ["bore_diameter_mm", "d", "i", "Bore diameter", "mm"],
  ["speed_rpm", "n", "", "Speed", "r/min"],
  ["torque_nm", "T", "", "Torque, both halves", "N·m"],
  ["mass_kg", "m", "", "Mass", "kg"],
  ["inertia_kg_m2", "J", "", "Moment of inertia", "kg·m²"],
];

/**
 * Rows of the pair's data; members without a value are left out.
 * @param {GearData} data
 * @returns {{ symbol: [string, string], name: string, value: number, unit: string }[]}
 */
export function pairRows(data) {
  return PAIR.flatMap(([key, letter, index, name, unit]) => {
    const value = data[key];
    return typeof value === "number" ? [{ symbol: [letter, index], name, value, unit }] : [];
  });
}

/**
 * Rows of the data of pinion and gear. Their own face widths are shown where one is wider than the common width.
 * @param {GearData} data
 * @returns {{ symbol: [string, string], name: string, pinion: number | string, gear: number | string, unit: string }[]}
 */
export function memberRows({ pinion, gear, face_width_mm: common }) {
  const isCommon = pinion.face_width_mm === common && gear.face_width_mm === common;
  const entries = MEMBERS.filter(([key]) => key !== "face_width_mm" || !isCommon);
  return entries.map(([key, letter, index, name, unit]) => ({ symbol: [letter, index], name, pinion: pinion[key], gear: gear[key], unit }));
}

/** A symbol with its index. @param {[string, string]} symbol */
export function symbolOf([letter, index]) {
  return letter ? el("span", { class: "symbol" }, el("i", {}, letter), index ? el("sub", {}, index) : null) : null;
}
