// The scalars of a result: name, unit and meaning of each, and its values in a result.

import { number, sentence, shownUnit } from "./format.js";
import { QUANTITIES } from "./quantities.js";

/** @typedef {import("./quantities.js").Quantity} Quantity */
/** @typedef {number | string | null} Scalar */
/** @typedef {{ left: Scalar, right: Scalar }} ScalarPerHalf */

const HALF = "{half}";

/** Every scalar, in the order of the result, with label and unit as people write them. @type {Quantity[]} */
export const SCALARS = QUANTITIES.map((quantity) => ({ ...quantity, label: sentence(quantity.label), unit: shownUnit(quantity.unit) }));

const BY_POINTER = new Map(SCALARS.map((scalar) => [scalar.pointer, scalar]));

/** The scalar at a pointer of the result; `{half}` in it stands for both halves. @param {string} pointer */
export function scalarAt(pointer) {
  const scalar = BY_POINTER.get(pointer);
  if (!scalar) throw new Error(`A result has no ${pointer}.`);
  return scalar;
}

/** @param {Quantity} scalar */
export const isPerHalf = (scalar) => scalar.pointer.includes(HALF);

/**
 * The value of a scalar: shares in per cent where they are shown so, flags as words, null where the result has none.
 * @param {object | null | undefined} result
 * @param {Quantity} scalar
 * @param {"left" | "right"} [half]
 * @returns {Scalar}
 */
export function valueOf(result, scalar, half = "left") {
  /** @type {any} */
  let value = result;
  for (const name of scalar.pointer.replace(HALF, half).split("/").slice(1)) value = value?.[name];
  if (typeof value === "boolean") return value ? "yes" : "no";
  return typeof value === "number" && scalar.percent ? 100 * value : (value ?? null);
}

/**
 * @param {object | null | undefined} result
 * @param {Quantity} scalar
 * @returns {ScalarPerHalf | null} null where neither half has a value
 */
export function valuesPerHalf(result, scalar) {
  const [left, right] = [valueOf(result, scalar, "left"), valueOf(result, scalar, "right")];
  return left === null && right === null ? null : { left, right };
}

/** Equal but for rounding. @param {any} a @param {any} b */
export const areAlike = (a, b) => a === b || Math.abs(a - b) <= 1e-9 * Math.max(Math.abs(a), Math.abs(b));

/**
 * Label, value, unit and meaning of a scalar; both halves in one row. The value is null where the result has none.
 * @param {object} result
 * @param {Quantity} scalar
 * @param {number} [digits]
 * @returns {[label: string, value: string | null, unit: string, meaning: Quantity]}
 */
export function rowOf(result, scalar, digits = 5) {
  const { label, unit } = scalar;
  /** @param {Scalar} value */
  const text = (value) => (typeof value === "number" ? number(value, digits) : value);
  if (!isPerHalf(scalar)) return [label, text(valueOf(result, scalar)), unit, scalar];
  const both = valuesPerHalf(result, scalar);
  if (!both) return [label, null, unit, scalar];
  if (areAlike(both.left, both.right)) return [`${label}, both halves`, text(both.left), unit, scalar];
  return [`${label}, left / right`, `${text(both.left)} / ${text(both.right)}`, unit, scalar];
}

/**
 * As `rowOf`, by the pointer.
 * @param {object} result
 * @returns {(pointer: string, digits?: number) => ReturnType<typeof rowOf>}
 */
export const rowsFrom = (result) => (pointer, digits) => rowOf(result, scalarAt(pointer), digits);
