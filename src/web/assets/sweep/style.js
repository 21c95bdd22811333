// Colour, dash and mark of branches and halves, the same in every plot.

/** Of the upward (or only) and the downward branch, left and right. */
const LOOKS = {
  up: { left: { colour: "--plot-1", dash: "solid" }, right: { colour: "--plot-3", dash: "dot" }, mark: "triangle-right" },
  down: { left: { colour: "--plot-2", dash: "dash" }, right: { colour: "--plot-4", dash: "dashdot" }, mark: "triangle-left" },
};

/** @param {string} branch */
const of = (branch) => LOOKS[branch === "down" ? "down" : "up"];

/** @param {string} branch */
export const markOf = (branch) => of(branch).mark;

/** @param {string} branch @param {string} side */
export const lookOf = (branch, side) => of(branch)[side === "right" ? "right" : "left"];

/** @type {Record<string, string>} */
const SIDES = { both: "", alike: "both halves alike" };

/** Name of a curve in the legend. @param {string} branch @param {string} side */
export const nameOf = (branch, side) => [SIDES[side] ?? side, branch].filter(Boolean).join(", ");

/** Colours of kinds as a scale with steps, for heat maps of whole numbers from 0. @param {string[]} colours */
export function steps(colours) {
  return colours.flatMap((colour, index) => [[index / colours.length, colour], [(index + 1) / colours.length, colour]]);
}

/** Hover text of an axis: its value with its unit. @param {string} name @param {string} unit @param {string} place */
export const hover = (name, unit, place) => `${name ? `${name} ` : ""}%{${place}:.6~g}${unit ? ` ${unit}` : ""}`;
