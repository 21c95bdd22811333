// Gear data as tables: the members of the API's answer with their names and symbols of ISO 21771-1.

import * as api from "./api.js";
import { el } from "./dom.js";
import { sentence, shownUnit } from "./format.js";
import { GEAR_DATA } from "./quantities.js";
import { valueOf } from "./scalars.js";

/** @typedef {import("./scalars.js").Scalar} Scalar */
/** @typedef {import("./quantities.js").Quantity} Quantity */

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

/** The scalars of the pair, and those of a gear: both have the same, so the pinion's stand for both. */
const PAIR = GEAR_DATA.filter(({ pointer }) => !/^\/(pinion|gear)\//.test(pointer));
const MEMBERS = GEAR_DATA.filter(({ pointer }) => pointer.startsWith("/pinion/"));

/** Symbol, name, unit and meaning of a scalar. @param {Quantity} scalar */
function namesOf(scalar) {
  const { symbol, label, unit } = scalar;
  const [letter, index = ""] = symbol.split("_");
  return { symbol: /** @type {[string, string]} */ ([letter, index]), name: sentence(label), unit: shownUnit(unit), meaning: scalar };
}

/**
 * Rows of the pair's data; members without a value are left out.
 * @param {GearData} data
 * @returns {{ symbol: [string, string], name: string, value: number, unit: string, meaning: Quantity }[]}
 */
export function pairRows(data) {
  return PAIR.flatMap((scalar) => {
    const value = valueOf(data, scalar);
    return typeof value === "number" ? [{ ...namesOf(scalar), value }] : [];
  });
}

/**
 * Rows of the data of pinion and gear. Their own face widths are shown where one is wider than the common width.
 * @param {GearData} data
 * @returns {(Omit<ReturnType<typeof namesOf>, never> & { pinion: Scalar, gear: Scalar })[]}
 */
export function memberRows({ pinion, gear, face_width_mm: common }) {
  const isCommon = pinion.face_width_mm === common && gear.face_width_mm === common;
  const scalars = MEMBERS.filter(({ pointer }) => pointer !== "/pinion/face_width_mm" || !isCommon);
  return scalars.map((scalar) => ({ ...namesOf(scalar), pinion: valueOf({ pinion }, scalar), gear: valueOf({ pinion: gear }, scalar) }));
}

/** A symbol with its index. @param {[string, string]} symbol */
export function symbolOf([letter, index]) {
  return letter ? el("span", { class: "symbol" }, el("i", {}, letter), index ? el("sub", {}, index) : null) : null;
}
