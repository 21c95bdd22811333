// The cost of a sweep before it is submitted: points, size of its rows, and the least time.

import { number } from "../common/format.js";

/** The service's limits: points of a sweep, and of one whose rows record more. */
const MOST_POINTS = 100_000;
const MOST_RECORDED = 5_000;
/** Size of a row, and largest sizes of the recorded data in it, kB. */
const ROW_KB = 0.55;
/** @type {Record<string, number>} */
const RECORD_KB = { poincare: 8, spectrum: 1.6 };
/**
 * Measured on two cores (docs/BENCHMARKS.md): a periodic point, an integrated one for each mesh period, and a mesh,
 * ms.
 */
const PERIODIC_MS = 2;
const MESH_PERIOD_MS = 0.02;
const MESH_MS = 14;
const THREADS = 2;
/** Inputs that leave the mesh as it is: one solution of it serves all points. */
const NOT_OF_THE_MESH = [/^\/operation\/pinion_speed_rpm$/, /^\/design\/supports\//, /\/(inertia_kg_m2|mass_kg|backlash_um|mesh_damping_ratio)$/, /^\/model\/impact\//];

/** @param {JobInput} document */
export function costOf(document) {
  const axes = document.axes ?? [];
  const lengths = axes.map(lengthOf);
  if (!axes.length || lengths.some((length) => !Number.isInteger(length) || length < 1)) return "";
  const places = lengths.reduce((product, length) => product * length, 1);
  const both = document.continuation === "both";
  const points = both ? 2 * places : places;
  const product = lengths.length > 1 ? lengths.map((length) => number(length)).join(" × ") : "";
  const count = [`${number(points)} ${points === 1 ? "point" : "points"}`, product || both ? ` (${[product || number(places), both ? "up and down" : ""].filter(Boolean).join(", ")})` : ""].join("");
  const record = document.record ?? [];
  if (places > MOST_POINTS) return `${count}: more than the ${number(MOST_POINTS)} that a sweep can have.`;
  if (record.length && places > MOST_RECORDED) return `${count}: more than the ${number(MOST_RECORDED)} of a sweep that records ${record.join(" and ")}.`;
  const kilobytes = points * record.reduce((size, what) => size + (RECORD_KB[what] ?? 0), ROW_KB);
  return `${count}; rows of ${record.length ? "up to " : ""}about ${size(kilobytes)}. ${timeOf(document, axes, lengths, points)}`;
}

function lengthOf({ values, points }) {
  if (Array.isArray(values)) return values.length;
  return points === undefined ? 50 : points;
}

function timeOf(document, axes, lengths, points) {
  const { source = "ltca", fidelity } = document.model?.mesh_stiffness ?? {};
  const meshes = source === "ltca" ? axes.reduce((product, { pointer }, index) => (NOT_OF_THE_MESH.some((pattern) => pattern.test(pointer)) ? product : product * lengths[index]), 1) : 0;
  const integrate = document.analysis?.method === "integrate";
  const response = integrate ? MESH_PERIOD_MS * (document.analysis.mesh_periods ?? 300) : PERIODIC_MS;
  // A continued line is followed by one thread.
  const lines = (lengths[1] ?? 1) * (document.continuation === "both" ? 2 : 1);
  const threads = (document.continuation ?? "none") === "none" ? THREADS : Math.min(THREADS, lines);
  const seconds = (points * response + meshes * MESH_MS) / 1000 / threads;
  const least = `It takes at least ${duration(seconds)} on two cores`;
  const slow = integrate ? "" : "; points whose motion never repeats take up to some hundred times as long as others";
  const elements = fidelity === "fe" ? "; finite elements take seconds more, for each gear that differs" : "";
  return `${least}${slow}${elements}.`;
}

const size = (kilobytes) => (kilobytes < 1000 ? `${number(Math.max(1, Math.round(kilobytes)))} kB` : `${number(kilobytes / 1000, 2)} MB`);

/** A duration for people: two digits, seconds to hours. @param {number} seconds */
export function durationOf(seconds) {
  if (seconds < 0.1) return "less than 0.1 s";
  return seconds < 10 ? `${number(seconds, 2)} s` : duration(seconds);
}

function duration(seconds) {
  if (seconds < 1) return "a fraction of a second";
  if (seconds < 90) return `${number(Math.ceil(seconds))} s`;
  if (seconds < 5400) return `${number(Math.ceil(seconds / 60))} min`;
  return `${number(seconds / 3600, 2)} h`;
}
