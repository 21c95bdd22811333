// The quantities of a point that can be plotted, and the kinds of its motion and contact.

/** @type {SweepQuantity[]} */
export const QUANTITIES = [
  half("mesh_circumferential_acceleration_rms", "m_s2", "Circumferential acceleration of the mesh, RMS", "m/s²", true),
  half("pinion_axial_acceleration_rms", "m_s2", "Axial acceleration of the pinion, RMS", "m/s²", true),
  whole("dynamic_factor", "Dynamic factor", "", true),
  half("tooth_force_max", "n", "Largest tooth force", "N", true),
  whole("min_displacement_um", "Least displacement of the mesh", "µm"),
  whole("impact_force_n", "Mesh-in impact force", "N", true),
  whole("stiffness_mean_n_per_um", "Mean mesh stiffness", "N/µm"),
  whole("total_contact_ratio", "Total contact ratio", ""),
  whole("loaded_contact_ratio", "Contact ratio under load", ""),
  whole("error_estimate", "Estimated relative error of the RMS", ""),
];

/**
 * @param {string} name
 * @param {string} unitName
 * @param {string} label
 * @param {string} unit
 * @param {boolean} [least]
 * @returns {SweepQuantity}
 */
function half(name, unitName, label, unit, least = false) {
  return { name, label, unit, least, columns: { left: `${name}_left_${unitName}`, right: `${name}_right_${unitName}` } };
}

/** @param {string} name @param {string} label @param {string} unit @param {boolean} [least] @returns {SweepQuantity} */
function whole(name, label, unit, least = false) {
  return { name, label, unit, least, columns: { both: name } };
}

/** @param {SweepQuantity} quantity */
export const columnsOf = (quantity) => Object.values(quantity.columns);

/** Columns that every view needs. */
export const ALWAYS = ["regime", "contact", "error"];

/** Kinds of motion, from the most to the least regular. @type {PointKind[]} */
export const REGIMES = [
  { is: (word) => word === "period-1", label: "period-1", detail: "repeats every mesh period", colour: "--regime-1" },
  { is: (word) => word === "period-2", label: "period-2", detail: "repeats every second mesh period", colour: "--regime-2" },
  { is: (word) => word.startsWith("period-"), label: "period-n", detail: "repeats after more mesh periods", colour: "--regime-3" },
  { is: (word) => word === "quasi-periodic", label: "quasi-periodic", detail: "never repeats, but is regular", colour: "--regime-4" },
  { is: (word) => word === "chaotic", label: "chaotic", detail: "never repeats and is irregular", colour: "--regime-5" },
  { is: (word) => word === "not-settled", label: "not settled", detail: "the record ended before the motion had settled", colour: "--regime-6" },
  { is: (word) => word === "unstable", label: "unstable", detail: "grows without bound", colour: "--regime-7" },
];

/** Kinds of contact. @type {PointKind[]} */
export const CONTACTS = [
  { is: (word) => word === "continuous", label: "continuous", detail: "the teeth never separate", colour: "--contact-1" },
  { is: (word) => word === "single-sided", label: "single-sided", detail: "the teeth separate and come back to the same flank", colour: "--contact-2" },
  { is: (word) => word === "double-sided", label: "double-sided", detail: "the teeth separate and also hit the other flank", colour: "--contact-3" },
  { is: (word) => word === "apart", label: "apart", detail: "the teeth do not touch", colour: "--contact-4" },
];

/** A point without a response. @type {PointKind} */
export const FAILED = { is: () => false, label: "no response", detail: "the point could not be solved; the table says why", colour: "--no-response" };

/**
 * Number of a word's kind; the number of kinds for a point without a response, null for one that is not solved yet.
 * @param {PointKind[]} kinds
 * @param {string | null} word
 * @param {string | null} error
 */
export function kindOf(kinds, word, error) {
  if (error) return kinds.length;
  if (!word) return null;
  const found = kinds.findIndex(({ is }) => is(word));
  return found < 0 ? null : found;
}
