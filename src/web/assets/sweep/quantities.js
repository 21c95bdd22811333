// The quantities of a point that can be plotted, and the kinds of its motion and contact.

import { SWEEP_COLUMNS } from "../common/quantities.js";
import { scalarAt } from "../common/scalars.js";

/** @type {SweepQuantity[]} */
export const QUANTITIES = [...new Set(SWEEP_COLUMNS.filter(({ kind, quantity }) => kind === "number" && quantity).map(({ group }) => group))].map((group) => {
  const columns = SWEEP_COLUMNS.filter((column) => column.group === group);
  const { label, unit, percent, change, theory, lower_is_better: least } = scalarAt(/** @type {string} */ (columns[0].quantity));
  // Rows have shares of 1.
  return { name: group, label, unit: percent ? "" : unit, change, least, needsShafts: theory.startsWith("shafts#"), columns: Object.fromEntries(columns.map(({ half, name }) => [half ?? "both", name])) };
});

/** Those that the points of a document can have. @param {JobInput} document */
export const quantitiesOf = (document) => QUANTITIES.filter(({ needsShafts }) => !needsShafts || document?.design?.shafts);

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
