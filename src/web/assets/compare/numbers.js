// The headline numbers of each job, in groups, and how they differ from the reference's.

import { number } from "../common/format.js";
import { valueText } from "../sweep/axes.js";

/**
 * A quantity: name, label, unit, and the function that finds it in a job. `change` says how differences are given: in
 * `percent`, as a `level` as well, in `points` of a percentage, `absolute`, or (a `word`) not at all.
 * @typedef {"percent" | "level" | "points" | "absolute" | "word"} Change
 * @typedef {{ value: number, at: string }} Finding a value with its place in a sweep
 * @typedef {Finding | number | string | null | undefined} Found
 * @typedef {{ left: Found, right: Found } | null | undefined} FoundPerHalf
 * @typedef {{ name: string, label: string, unit: string, change?: Change }} Described
 * @typedef {Described & { pick: (job: ComparedJob) => Found }} Quantity
 * @typedef {Described & { pickBoth: (job: ComparedJob) => FoundPerHalf }} QuantityPerHalf
 */

/**
 * @type {(name: string, label: string, unit: string, pick: Quantity["pick"], options?: { change?: Change }) =>
 *   Quantity}
 */
const quantity = (name, label, unit, pick, options = {}) => ({ name, label, unit, pick, ...options });

/**
 * A value per half: one row when the halves are alike in all jobs.
 * @type {(name: string, label: string, unit: string, pick: QuantityPerHalf["pickBoth"], options?: { change?: Change })
 * => QuantityPerHalf}
 */
const halves = (name, label, unit, pick, options) => ({ name, label, unit, pickBoth: pick, ...options });

/**
 * Finds a member of a part of the result.
 * @template {"geometry" | "impact" | "mesh" | "response"} Part
 * @param {Part} part
 * @param {keyof NonNullable<JobResult[Part]>} name
 * @returns {Quantity["pick"]}
 */
const of = (part, name) => ({ result }) => /** @type {any} */ (result?.[part])?.[name];

/** @type {[string, (Quantity | QuantityPerHalf)[]][]} */
const GROUPS = [
  ["Vibration", [
    halves("circumferential", "Circumferential acceleration of the mesh, RMS", "m/s²", ({ result }) => result?.response?.rms?.mesh_circumferential_acceleration_m_s2, { change: "level" }),
    halves("axial", "Axial acceleration of the pinion, RMS", "m/s²", ({ result }) => result?.response?.rms?.pinion_axial_acceleration_m_s2, { change: "level" }),
    quantity("dynamic_factor", "Dynamic factor", "", of("response", "dynamic_factor")),
    halves("tooth_force_max_n", "Largest tooth force", "N", ({ result }) => extremeOfHalves(result, "max")),
    halves("tooth_force_min_n", "Least tooth force", "N", ({ result }) => extremeOfHalves(result, "min"), { change: "absolute" }),
    quantity("regime", "Motion", "", of("response", "regime"), { change: "word" }),
    quantity("contact", "Contact", "", of("response", "contact"), { change: "word" }),
    quantity("min_displacement_um", "Least mesh displacement", "µm", of("response", "min_displacement_um"), { change: "absolute" }),
    quantity("mesh_frequency_hz", "Mesh frequency", "Hz", ({ result }) => result?.response?.mesh_frequency_hz ?? result?.geometry?.mesh_frequency_hz),
  ]],
  ["Mesh-in impact", [
    quantity("force_n", "Impact force", "N", of("impact", "force_n")),
    quantity("zhou2008_force_n", "Impact force after Zhou 2008", "N", of("impact", "zhou2008_force_n")),
    quantity("reduction_percent", "Reduction by the pairs in mesh", "%", of("impact", "reduction_percent"), { change: "points" }),
    quantity("velocity_m_s", "Impact velocity", "m/s", of("impact", "velocity_m_s")),
    quantity("duration_us", "Impact duration", "µs", of("impact", "duration_us")),
  ]],
  ["Mesh of one half", [
    quantity("stiffness_mean_n_per_um", "Mean mesh stiffness", "N/µm", of("mesh", "stiffness_mean_n_per_um")),
    quantity("stiffness_swing", "Mesh stiffness, peak to peak", "N/µm", ({ result }) => swing(result?.mesh)),
    quantity("transmission_error_pp_um", "Transmission error, peak to peak", "µm", of("mesh", "transmission_error_pp_um")),
    quantity("transmission_error_mean_um", "Transmission error, mean", "µm", of("mesh", "transmission_error_mean_um")),
    quantity("load_share_at_mesh_in", "Load share at mesh-in", "", of("mesh", "load_share_at_mesh_in"), { change: "absolute" }),
    quantity("max_line_load_n_per_mm", "Largest line load", "N/mm", of("mesh", "max_line_load_n_per_mm")),
    quantity("max_contact_pressure_mpa", "Largest contact pressure", "MPa", of("mesh", "max_contact_pressure_mpa")),
  ]],
  ["Geometry", [
    quantity("transverse_contact_ratio", "Transverse contact ratio ε_α", "", of("geometry", "transverse_contact_ratio")),
    quantity("overlap_ratio", "Overlap ratio ε_β", "", of("geometry", "overlap_ratio")),
    quantity("total_contact_ratio", "Total contact ratio ε_γ", "", of("geometry", "total_contact_ratio")),
    quantity("loaded_contact_ratio", "Total contact ratio under load", "", of("mesh", "loaded_contact_ratio")),
    quantity("working_pressure_angle_deg", "Working transverse pressure angle α_wt", "°", of("geometry", "working_pressure_angle_deg"), { change: "absolute" }),
    quantity("center_distance_mm", "Centre distance a", "mm", of("geometry", "center_distance_mm")),
  ]],
  ["Sweep", [
    halves("sweep_circumferential", "Largest circumferential acceleration, RMS", "m/s²", ({ sweep }) => largestOfHalves(sweep, "mesh_circumferential_acceleration_rms"), { change: "level" }),
    halves("sweep_axial", "Largest axial acceleration of the pinion, RMS", "m/s²", ({ sweep }) => largestOfHalves(sweep, "pinion_axial_acceleration_rms"), { change: "level" }),
    quantity("sweep_dynamic_factor", "Largest dynamic factor", "", ({ sweep }) => largest(sweep, "dynamic_factor")),
    halves("sweep_tooth_force", "Largest tooth force", "N", ({ sweep }) => largestOfHalves(sweep, "tooth_force_max", "n")),
    quantity("sweep_separated", "Points at which the teeth separate", "", ({ sweep }) => sweep?.data.column("contact").filter((word) => word && word !== "continuous").length, { change: "absolute" }),
    quantity("sweep_points", "Points solved", "", ({ sweep }) => sweep?.data.n, { change: "absolute" }),
  ]],
];

/** @param {JobResult | undefined} result @param {"max" | "min"} which */
function extremeOfHalves(result, which) {
  const forces = result?.response?.tooth_force_n;
  return forces ? { left: forces.left[which], right: forces.right[which] } : null;
}

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

/** @param {ComparedJob["sweep"]} sweep @param {string} name */
function largestOfHalves(sweep, name, unit = "m_s2") {
  const [left, right] = ["left", "right"].map((half) => largest(sweep, `${name}_${half}_${unit}`));
  return left || right ? { left, right } : null;
}

/** @type {(found: Found) => found is Finding} */
const isFinding = (found) => found !== null && typeof found === "object";
/** @param {Found} found */
const valueOf = (found) => (isFinding(found) ? found.value : found);
/** @param {any} a @param {any} b */
const alike = (a, b) => a === b || Math.abs(a - b) <= 1e-9 * Math.abs(a);

/** Groups of the quantities that at least one job has. @param {ComparedJob[]} jobs */
export function groupsOf(jobs) {
  return GROUPS.map(([title, quantities]) => ({ title, rows: quantities.flatMap((entry) => rowsOf(entry, jobs)) })).filter(({ rows }) => rows.length > 0);
}

/** @param {Quantity | QuantityPerHalf} entry @param {ComparedJob[]} jobs */
function rowsOf(entry, jobs) {
  if ("pick" in entry) return row(entry, entry.label, jobs.map(entry.pick));
  const both = jobs.map((job) => entry.pickBoth(job));
  const isSymmetric = both.every((pair) => !pair || alike(valueOf(pair.left), valueOf(pair.right)));
  if (isSymmetric) return row({ ...entry, name: `${entry.name}-both` }, `${entry.label}, both halves`, both.map((pair) => pair?.left));
  return /** @type {const} */ (["left", "right"]).flatMap((half) => row({ ...entry, name: `${entry.name}-${half}` }, `${entry.label}, ${half}`, both.map((pair) => pair?.[half])));
}

/** @param {Described} entry @param {string} label @param {Found[]} found */
function row({ name, unit, change = "percent" }, label, found) {
  const cells = found.map((one) => ({ value: valueOf(one) ?? null, at: isFinding(one) ? one.at : null }));
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
  if (typeof value !== "number" || typeof reference !== "number" || change === "word") return "";
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
