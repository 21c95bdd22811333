// Numbers, names, units and times as text.

import { UNIT_SYMBOLS } from "./units.js";

/** Endings of field names and the units they stand for; longer endings first. */
const UNITS = [
  ["_nm_per_rad", "N·m/rad"], ["_n_per_mm_um", "N/(mm·µm)"], ["_kg_m2", "kg·m²"], ["_kg_m3", "kg/m³"], ["_n_per_um", "N/µm"], ["_n_per_mm", "N/mm"], ["_m_s2", "m/s²"], ["_m_s", "m/s"],
  ["_percent", "%"], ["_mpa", "MPa"], ["_gpa", "GPa"], ["_deg", "°"], ["_rad", "rad"], ["_rpm", "r/min"], ["_hz", "Hz"],
  ["_nm", "N·m"], ["_mm", "mm"], ["_um", "µm"], ["_us", "µs"], ["_ms", "ms"], ["_kg", "kg"], ["_n", "N"], ["_m", "m"],
];

/** Unit of a field, from its name. @param {string} name */
export function unitOf(name) {
  return UNITS.find(([ending]) => name.endsWith(ending))?.[1] ?? "";
}

/** A unit of the API as it is shown. @param {string | null | undefined} unit */
export const shownUnit = (unit) => (unit === "1" ? "" : (UNIT_SYMBOLS[unit ?? ""] ?? unit ?? ""));

/** A field's name as words, without its unit. @param {string} name */
export function labelOf(name) {
  const ending = UNITS.find(([ending]) => name.endsWith(ending))?.[0] ?? "";
  return sentence(name.slice(0, name.length - ending.length).replaceAll("_", " ").replace("center", "centre"));
}

/** @param {string} text */
export const sentence = (text) => text.charAt(0).toUpperCase() + text.slice(1);

/** The last name of a JSON pointer as words, with the members around it, and its unit. @param {string} pointer */
export function pointerLabel(pointer) {
  const parts = pointer.split("/").filter((part) => part && part !== "design" && part !== "operation" && part !== "model");
  const unit = unitOf(parts.at(-1) ?? "");
  const words = [...parts.slice(0, -1).map((part) => part.replaceAll("_", " ")), labelOf(parts.at(-1) ?? pointer)];
  return { label: sentence(words.join(" ").toLowerCase()), unit };
}

/**
 * A number with `digits` significant digits; other values as they are.
 * @param {unknown} value
 * @param {number} [digits]
 */
export function number(value, digits = 5) {
  if (value === null || value === undefined) return "–";
  if (typeof value !== "number") return String(value);
  if (!Number.isFinite(value)) return "–";
  if (value === 0) return "0";
  const size = Math.abs(value);
  if (size >= 1e7 || size < 1e-3) {
    const [mantissa, exponent] = value.toExponential(digits - 1).split("e");
    return `${Number(mantissa)}·10${superscript(Number(exponent))}`;
  }
  if (Number.isInteger(value)) return grouped(String(value));
  const decimals = Math.max(0, digits - 1 - Math.floor(Math.log10(size)));
  const text = value.toFixed(decimals);
  return grouped(decimals > 0 ? text.replace(/\.?0+$/, "") : text);
}

/** @param {number} exponent */
function superscript(exponent) {
  return [...String(exponent)].map((sign) => (sign === "-" ? "⁻" : "⁰¹²³⁴⁵⁶⁷⁸⁹"[Number(sign)])).join("");
}

/** Thin spaces between thousands, from five digits on. @param {string} text */
function grouped(text) {
  const [whole, fraction] = text.split(".");
  const spaced = whole.replace("-", "").length > 4 ? whole.replace(/\B(?=(\d{3})+$)/g, "\u202f") : whole;
  return (fraction === undefined ? spaced : `${spaced}.${fraction}`).replace("-", "−");
}

/** @param {number | null | undefined} fraction */
export const percent = (fraction) => `${Math.round((fraction ?? 0) * 100)} %`;

/** Time since an instant, as text. @param {string} timestamp */
export function age(timestamp, now = Date.now()) {
  const seconds = Math.max(0, Math.round((now - Date.parse(timestamp)) / 1000));
  if (!Number.isFinite(seconds)) return "";
  if (seconds < 60) return `${seconds} s ago`;
  if (seconds < 3600) return `${Math.floor(seconds / 60)} min ago`;
  if (seconds < 86_400) return `${Math.floor(seconds / 3600)} h ago`;
  return `${Math.floor(seconds / 86_400)} d ago`;
}

/** Date and time as the browser writes them. @param {string} timestamp */
export function instant(timestamp) {
  const date = new Date(timestamp);
  return Number.isNaN(date.getTime()) ? "" : date.toLocaleString();
}

/** Day and time without seconds, as the browser writes them. @param {string} timestamp */
export function dayAndTime(timestamp) {
  const date = new Date(timestamp);
  return Number.isNaN(date.getTime()) ? "" : date.toLocaleString([], { dateStyle: "medium", timeStyle: "short" });
}

/** Seconds between two instants; null where there is none. @param {string} from @param {string} to */
export function seconds(from, to) {
  const span = (Date.parse(to) - Date.parse(from)) / 1000;
  return Number.isFinite(span) && span >= 0 ? span : null;
}
