// The headline numbers of each job, in groups, and how they differ from the reference's.

import { number } from "../common/format.js";
import { SCALARS, areAlike, isPerHalf, scalarAt, valueOf, valuesPerHalf } from "../common/scalars.js";
import { valueText } from "../sweep/axes.js";
import { QUANTITIES } from "../sweep/quantities.js";

/**
 * A row of the table: name, label, unit, and the function that finds its value in a job.
 * @typedef {import("../common/scalars.js").Quantity} Scalar
 * @typedef {Scalar["change"]} Change
 * @typedef {{ value: number, at: string }} Finding a value with its place in a sweep
 * @typedef {Finding | number | string | null | undefined} Found
 * @typedef {{ left: Found, right: Found } | null | undefined} FoundPerHalf
 * @typedef {{ name: string, label: string, unit: string, change?: Change }} Described
 * @typedef {Described & { pick: (job: ComparedJob) => Found }} Quantity
 * @typedef {Described & { pickBoth: (job: ComparedJob) => FoundPerHalf }} QuantityPerHalf one row when the halves are
 * alike in all jobs
 */

/** @param {Scalar} scalar @returns {Quantity | QuantityPerHalf} */
function ofResult(scalar) {
  const { pointer, label, symbol, unit, change } = scalar;
  const described = { name: pointer, label: symbol ? `${label} ${symbol}` : label, unit, change };
  if (isPerHalf(scalar)) return { ...described, pickBoth: ({ result }) => valuesPerHalf(result, scalar) };
  return { ...described, pick: ({ result }) => valueOf(result, scalar) };
}

/** The largest value of a quantity of a sweep. @param {SweepQuantity} quantity @returns {Quantity | QuantityPerHalf} */
function ofSweep({ name, label, unit, change, columns: { both, left, right } }) {
  const described = { name: `sweep ${name}`, label: `${label}, largest of the sweep`, unit, change };
  if (both) return { ...described, pick: ({ sweep }) => largest(sweep, both) };
  return { ...described, pickBoth: ({ sweep }) => (sweep && left && right ? { left: largest(sweep, left), right: largest(sweep, right) } : null) };
}

/**
 * Scalars of the result by their pointers, and rows of other origin.
 * @type {[string, (string | Quantity | QuantityPerHalf)[]][]}
 */
const CHOSEN = [
  ["Vibration", [
    "/response/rms/mesh_circumferential_acceleration_m_s2/{half}", "/response/rms/pinion_axial_acceleration_m_s2/{half}", "/response/dynamic_factor",
    "/response/tooth_force_n/{half}/max", "/response/tooth_force_n/{half}/min", "/response/regime", "/response/contact", "/response/min_displacement_um",
    "/geometry/mesh_frequency_hz",
  ]],
  ["Mesh-in impact", ["/impact/force_n", "/impact/zhou2008_force_n", "/impact/reduction_percent", "/impact/velocity_m_s", "/impact/duration_us"]],
  ["Mesh of one half", [
    "/mesh/stiffness_mean_n_per_um",
    { name: "stiffness_swing", label: "Mesh stiffness of one half, peak to peak", unit: scalarAt("/mesh/stiffness_mean_n_per_um").unit, pick: ({ result }) => swing(result?.mesh) },
    "/mesh/transmission_error_pp_um", "/mesh/transmission_error_mean_um", "/mesh/load_share_at_mesh_in", "/mesh/max_line_load_n_per_mm", "/mesh/max_contact_pressure_mpa",
  ]],
  ["Shafts", [
    "/shafts/{half}/k_h_beta", "/shafts/{half}/k_h_beta_5mm", "/shafts/k_gamma", "/shafts/transmission_error/between_couplings_mean_um",
    "/shafts/transmission_error/harmonics_um/0", "/shafts/{half}/helix_modification/slope_um", "/shafts/{half}/helix_modification/crowning_um",
    "/shafts/{half}/helix_modification/k_h_beta_5mm", "/response/largest_bearing_force_rms_n", "/response/lowest_natural_frequency_hz",
  ]],
  ["Geometry", [
    "/geometry/transverse_contact_ratio", "/geometry/overlap_ratio", "/geometry/total_contact_ratio", "/mesh/loaded_contact_ratio", "/geometry/working_pressure_angle_deg",
    "/geometry/center_distance_mm",
  ]],
  ["Sweep", [
    ...QUANTITIES.filter(({ least }) => least).map(ofSweep),
    { name: "sweep_separated", label: "Points at which the teeth separate", unit: "", change: "absolute", pick: ({ sweep }) => sweep?.data.column("contact").filter((word) => word && word !== "continuous").length },
    { name: "sweep_points", label: "Points solved", unit: "", change: "absolute", pick: ({ sweep }) => sweep?.data.n },
  ]],
];

const chosen = new Set(CHOSEN.flatMap(([, entries]) => entries));

/** @type {{ title: string, isFolded: boolean, entries: (Quantity | QuantityPerHalf)[] }[]} */
const GROUPS = [
  ...CHOSEN.map(([title, entries]) => ({ title, isFolded: false, entries: entries.map((entry) => (typeof entry === "string" ? ofResult(scalarAt(entry)) : entry)) })),
  { title: "All other values", isFolded: true, entries: SCALARS.filter(({ pointer }) => !chosen.has(pointer)).map(ofResult) },
];

/** @param {MeshResult | null | undefined} mesh */
function swing(mesh) {
  const [least, most] = [mesh?.stiffness_min_n_per_um, mesh?.stiffness_max_n_per_um];
  return typeof least === "number" && typeof most === "number" ? most - least : null;
}

/**
 * The largest value of a column, and where it is.
 * @param {ComparedJob["sweep"]} sweep
 * @param {string} name
 * @returns {Finding | null}
 */
function largest(sweep, name) {
  const values = sweep?.data.column(name) ?? [];
  let found = -1;
  values.forEach((value, position) => {
    if (found < 0 ? !Number.isNaN(value) : value > values[found]) found = position;
  });
  if (found < 0 || !sweep) return null;
  const places = sweep.grid.valuesAt(found).map((value, index) => valueText(sweep.grid.axes[index], value));
  return { value: values[found], at: `at ${places.join(", ")}` };
}

/** @type {(found: Found) => found is Finding} */
const isFinding = (found) => found !== null && typeof found === "object";
/** @param {Found} found */
const plain = (found) => (isFinding(found) ? found.value : found);

/** Groups of the quantities that at least one job has. @param {ComparedJob[]} jobs */
export function groupsOf(jobs) {
  return GROUPS.map(({ title, isFolded, entries }) => ({ title, isFolded, rows: entries.flatMap((entry) => rowsOf(entry, jobs)) })).filter(({ rows }) => rows.length > 0);
}

/** @param {Quantity | QuantityPerHalf} entry @param {ComparedJob[]} jobs */
function rowsOf(entry, jobs) {
  if ("pick" in entry) return row(entry, entry.label, jobs.map(entry.pick));
  const both = jobs.map((job) => entry.pickBoth(job));
  const isSymmetric = both.every((pair) => !pair || areAlike(plain(pair.left), plain(pair.right)));
  if (isSymmetric) return row({ ...entry, name: `${entry.name}-both` }, `${entry.label}, both halves`, both.map((pair) => pair?.left));
  return /** @type {const} */ (["left", "right"]).flatMap((half) => row({ ...entry, name: `${entry.name}-${half}` }, `${entry.label}, ${half}`, both.map((pair) => pair?.[half])));
}

/** @param {Described} entry @param {string} label @param {Found[]} found */
function row({ name, unit, change = "percent" }, label, found) {
  const cells = found.map((one) => ({ value: plain(one) ?? null, at: isFinding(one) ? one.at : null }));
  return cells.every(({ value }) => value === null) ? [] : [{ name, label, unit, change, cells }];
}

/**
 * The difference of a value from the reference's, as text; empty where there is none to give.
 * @param {unknown} value
 * @param {unknown} reference
 * @param {Change} change
 * @param {string} unit
 */
export function difference(value, reference, change, unit) {
  if (typeof value !== "number" || typeof reference !== "number" || change === "none") return "";
  const by = value - reference;
  if (by === 0) return "=";
  const sign = by > 0 ? "+" : "";
  if (change === "points") return `${sign}${number(by, 3)} points`;
  if (change === "absolute" || reference === 0) return `${sign}${number(by, 3)}${unit ? ` ${unit}` : ""}`;
  const percent = (100 * by) / Math.abs(reference);
  if (Math.abs(percent) < 5e-4) return "≈";
  const relative = percent >= 1000 ? `×${number(value / reference, 3)}` : `${sign}${number(percent, 3)} %`;
  // Vibration is compared by levels, too.
  const level = change === "level" && value > 0 && reference > 0 ? 20 * Math.log10(value / reference) : null;
  return level === null ? relative : `${relative}, ${sign}${number(Number(level.toFixed(Math.abs(level) < 1 ? 2 : 1)), 3)} dB`;
}
