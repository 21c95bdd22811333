// What a point has: the quantities that can be plotted, and the words for its motion.

/** A quantity: its columns by half (or one column for both), its name and unit; `least` marks those of which less is better. */
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

function half(name, unitName, label, unit, least = false) {
  return { name, label, unit, least, columns: { left: `${name}_left_${unitName}`, right: `${name}_right_${unitName}` } };
}

function whole(name, label, unit, least = false) {
  return { name, label, unit, least, columns: { both: name } };
}

export const columnsOf = (quantity) => Object.values(quantity.columns);

/** Columns that every view needs. */
export const ALWAYS = ["regime", "contact", "error"];

/** Kinds of motion, from the simplest to the wildest; `colour` is a variable of the stylesheet. */
export const REGIMES = [
  { is: (word) => word === "period-1", label: "period-1", detail: "repeats every mesh period", colour: "--regime-1" },
  { is: (word) => word === "period-2", label: "period-2", detail: "repeats every second mesh period", colour: "--regime-2" },
  { is: (word) => word.startsWith("period-"), label: "period-n", detail: "repeats after more mesh periods", colour: "--regime-3" },
  { is: (word) => word === "quasi-periodic", label: "quasi-periodic", detail: "never repeats, but is regular", colour: "--regime-4" },
  { is: (word) => word === "chaotic", label: "chaotic", detail: "never repeats and is irregular", colour: "--regime-5" },
  { is: (word) => word === "not-settled", label: "not settled", detail: "the record ended before the motion had settled", colour: "--regime-6" },
  { is: (word) => word === "unstable", label: "unstable", detail: "grows without bound", colour: "--regime-7" },
];

/** What the teeth do. */
export const CONTACTS = [
  { is: (word) => word === "continuous", label: "continuous", detail: "the teeth never separate", colour: "--contact-1" },
  { is: (word) => word === "single-sided", label: "single-sided", detail: "the teeth separate and come back to the same flank", colour: "--contact-2" },
  { is: (word) => word === "double-sided", label: "double-sided", detail: "the teeth separate and also hit the other flank", colour: "--contact-3" },
  { is: (word) => word === "apart", label: "apart", detail: "the teeth do not touch", colour: "--contact-4" },
];

export const FAILED = { label: "no response", detail: "the point could not be solved; the table says why", colour: "--no-response" };

/** Number of a word's kind; the number of kinds for a point without a response, null for one that is not solved yet. */
export function kindOf(kinds, word, error) {
  if (error) return kinds.length;
  if (!word) return null;
  const found = kinds.findIndex(({ is }) => is(word));
  return found < 0 ? null : found;
}
