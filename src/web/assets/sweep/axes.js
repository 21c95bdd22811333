// The swept inputs of a document: their names, units and values, and the place of each point on them.

import { number, pointerLabel } from "../common/format.js";
import { gridOf } from "../common/grid.js";

/**
 * The axes of a sweep's document.
 * @typedef {{ pointer: string, label: string, unit: string, title: string, values: number[], logarithmic: boolean }}
 * Axis
 * @param {JobInput} document
 * @returns {Axis[]}
 */
function axesOf(document) {
  return document.axes.map((/** @type {any} */ axis) => {
    const { label, unit } = pointerLabel(axis.pointer);
    const logarithmic = axis.spacing === "logarithmic";
    return { pointer: axis.pointer, label, unit, title: withUnit(label, unit), values: valuesOf(axis), logarithmic };
  });
}

/** The values of an axis as the solver has them. @param {any} axis @returns {number[]} */
const valuesOf = (axis) => axis.values ?? gridOf(axis);

/** @param {string} label @param {string} unit */
export const withUnit = (label, unit) => (unit ? `${label}, ${unit}` : label);

/** A value with the unit of its axis, as text. @param {Axis} axis @param {number} value */
export const valueText = (axis, value) => [number(value, 7), axis.unit].filter(Boolean).join(" ");

/**
 * Places of the rows: the first axis runs first, then the second; with two directions the downward rows follow the
 * upward ones.
 */
export class Grid {
  /** @param {JobInput} document */
  constructor(document) {
    this.axes = axesOf(document);
    this.length = this.axes[0].values.length;
    this.lines = this.axes[1]?.values.length ?? 1;
    const { continuation } = document;
    this.branches = continuation === "both" ? ["up", "down"] : continuation === "up" || continuation === "down" ? [continuation] : [""];
    this.total = this.length * this.lines * this.branches.length;
    /** Places on the first axis from its least value up. */
    this.order = ascending(this.axes[0].values);
    this.secondOrder = this.axes[1] ? ascending(this.axes[1].values) : [0];
  }

  /** Position of a row. @param {number} first @param {number} [second] @param {number} [branch] */
  at(first, second = 0, branch = 0) {
    return (branch * this.lines + second) * this.length + first;
  }

  /** Place of a row: indices on the axes and of the branch. @param {number} position */
  placeOf(position) {
    const line = Math.floor(position / this.length);
    return { first: position % this.length, second: line % this.lines, branch: Math.floor(line / this.lines) };
  }

  /** Values of the axes at a row. @param {number} position */
  valuesAt(position) {
    const { first, second } = this.placeOf(position);
    return [this.axes[0].values[first], ...(this.axes[1] ? [this.axes[1].values[second]] : [])];
  }

  /** What varies, from where to where and in how many values, and how the points were reached. */
  describeAxes() {
    const told = this.axes.map((axis) => {
      const n = axis.values.length;
      const [least, greatest] = axis.values.reduce(([low, high], value) => [Math.min(low, value), Math.max(high, value)], [Infinity, -Infinity]);
      return n === 1 ? `${axis.label} ${valueText(axis, least)}` : `${axis.label} from ${number(least, 7)} to ${valueText(axis, greatest)} in ${number(n)} values`;
    });
    const [branch] = this.branches;
    const ways = this.branches.length === 2 ? "followed up and down" : branch ? `followed ${branch}` : "each point for itself";
    return `${told.join("; ")}; ${ways}.`;
  }

  /** A point in words: "Pinion speed 2000 r/min, on the way up". @param {number} position */
  describe(position) {
    const values = this.valuesAt(position);
    const branch = this.branches[this.placeOf(position).branch];
    const places = this.axes.map((axis, index) => `${axis.label.toLowerCase()} ${valueText(axis, values[index])}`);
    return [places.join(", "), branch ? `on the way ${branch}` : ""].filter(Boolean).join(", ");
  }
}

/** Indices in the order of ascending values. @param {number[]} values */
function ascending(values) {
  return Array.from(values.keys()).sort((a, b) => values[a] - values[b]);
}
