// The swept inputs of a document: their names, units and values, and where a point of the table stands on them.

import { number, pointerLabel } from "../common/format.js";
import { gridOf } from "../common/grid.js";

/** The axes of a sweep's document: {pointer, label, unit, title, values, logarithmic}. */
export function axesOf(document) {
  return document.axes.map((axis) => {
    const { label, unit } = pointerLabel(axis.pointer);
    const logarithmic = axis.spacing === "logarithmic";
    return { pointer: axis.pointer, label, unit, title: withUnit(label, unit), values: valuesOf(axis), logarithmic };
  });
}

/** The values of an axis as the solver counts them. */
const valuesOf = (axis) => axis.values ?? gridOf(axis);

export const withUnit = (label, unit) => (unit ? `${label}, ${unit}` : label);

/** A value with the unit of its axis, for people. */
export const valueText = (axis, value) => [number(value, 7), axis.unit].filter(Boolean).join(" ");

/** Where the rows stand: the first axis runs first, then the second; with two directions the downward rows follow the upward ones. */
export class Grid {
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

  /** Position of a row. */
  at(first, second = 0, branch = 0) {
    return (branch * this.lines + second) * this.length + first;
  }

  /** Where a row stands: places on the axes and number of the branch. */
  placeOf(position) {
    const line = Math.floor(position / this.length);
    return { first: position % this.length, second: line % this.lines, branch: Math.floor(line / this.lines) };
  }

  valuesAt(position) {
    const { first, second } = this.placeOf(position);
    return [this.axes[0].values[first], ...(this.axes[1] ? [this.axes[1].values[second]] : [])];
  }

  /** A point in words: "Pinion speed 2000 r/min, on the way up". */
  describe(position) {
    const values = this.valuesAt(position);
    const branch = this.branches[this.placeOf(position).branch];
    const places = this.axes.map((axis, index) => `${axis.label.toLowerCase()} ${valueText(axis, values[index])}`);
    return [places.join(", "), branch ? `on the way ${branch}` : ""].filter(Boolean).join(", ");
  }
}

function ascending(values) {
  return Array.from(values.keys()).sort((a, b) => values[a] - values[b]);
}
