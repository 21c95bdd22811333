// What differs from the document that the form was started with, before it is submitted.

import { byId, el } from "../common/dom.js";
import { fieldsOf, isSame, textIn, textOf } from "./document.js";
import { linkTo } from "./errors.js";

/** @typedef {import("./document.js").Field} Field */
/** @typedef {import("./draft.js").Start} Start */

/**
 * The fields that differ from the start, with their text there.
 * @param {HTMLElement} form @param {Start} start
 * @returns {{ field: Field, before: string }[]}
 */
export function changesFrom(form, start) {
  const used = fieldsOf(form).filter(({ box }) => !box.hidden);
  return used.map((field) => ({ field, before: textIn(field, start.document) })).filter(({ field, before }) => !isSame(field, textOf(field), before));
}

/**
 * Lists the differences, and the values that are still those of the start though its geometry is not.
 * @param {HTMLElement} form @param {Start} start @param {Field[]} stale
 */
export function showChanges(form, start, stale) {
  const changes = changesFrom(form, start);
  const count = changes.length;
  byId("changes-title").textContent = count ? `Changed from ${start.title}: ${count} ${count === 1 ? "field" : "fields"}` : `As in ${start.title}`;
  byId("changes-list").replaceChildren(...changes.map(({ field, before }) =>
    el("li", {}, linkTo(field), " ", el("del", {}, shown(field, before)), " → ", el("ins", {}, shown(field, textOf(field))))));
  const left = stale.filter((field) => isSame(field, textOf(field), textIn(field, start.document)));
  byId("changes-unchanged").replaceChildren(...(left.length
    ? [`Not changed, though the geometry is another: `, ...left.flatMap((field, index) => [index ? ", " : "", linkTo(field), ` ${shown(field, textOf(field))}`]), "."]
    : []));
}

/** @param {Field} field @param {string} text */
function shown({ control, input, unit, default: ofDefault }, text) {
  if (text === "") return ofDefault === "" && input.placeholder ? "derived" : "empty";
  if (control === "boolean") return text === "true" ? "yes" : "no";
  if (control === "choice") return [...input.options].find(({ value }) => value === text)?.textContent ?? text;
  const clipped = text.length > 40 ? `${text.slice(0, 39)}…` : text;
  return unit && /\d$/.test(clipped) ? `${clipped} ${unit}` : clipped;
}
