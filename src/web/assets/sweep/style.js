// How branches and halves are told apart: by colour, dash and mark, everywhere the same.

/** Of the upward (or only) and the downward branch, left and right. */
const LOOKS = {
  up: { left: { colour: "--plot-1", dash: "solid" }, right: { colour: "--plot-3", dash: "dot" }, mark: "triangle-right" },
  down: { left: { colour: "--plot-2", dash: "dash" }, right: { colour: "--plot-4", dash: "dashdot" }, mark: "triangle-left" },
};

const of = (branch) => LOOKS[branch === "down" ? "down" : "up"];

export const markOf = (branch) => of(branch).mark;

export const lookOf = (branch, side) => of(branch)[side === "right" ? "right" : "left"];

/** Name of a curve in the legend. */
export const nameOf = (branch, side) => [{ both: "", alike: "both halves alike" }[side] ?? side, branch].filter(Boolean).join(", ");

/** Colours of kinds as a scale with steps, for heat maps of whole numbers from 0. */
export function steps(colours) {
  return colours.flatMap((colour, index) => [[index / colours.length, colour], [(index + 1) / colours.length, colour]]);
}

/** Hover text of an axis: its value with its unit. */
export const hover = (name, unit, place) => `${name ? `${name} ` : ""}%{${place}:.6~g}${unit ? ` ${unit}` : ""}`;
