// Between the form and the job document: the value of each field, and its place in the document.

import { byAnyId, byId } from "../common/dom.js";
import { pointerLabel } from "../common/format.js";
import { countAt, fillLists } from "./lists.js";
import { readField, readList } from "./typed.js";

/**
 * The fields of the form, in order.
 * @typedef {{
 *   box: HTMLElement, pointer: string, label: string, row: string | undefined, unit: string, control: string,
 *   default: string, required: boolean, input: any,
 * }} Field `row` is the row that fields of pinion and gear share
 * @param {HTMLElement} form
 * @returns {Field[]}
 */
export function fieldsOf(form) {
  return [...form.querySelectorAll("[data-pointer]")].map((node) => /** @type {HTMLElement} */ (node)).map((box) => ({
    box,
    pointer: box.dataset.pointer ?? "",
    label: box.dataset.label ?? box.querySelector("label")?.firstChild?.textContent?.trim() ?? "",
    row: box.dataset.row,
    unit: box.dataset.unit ?? "",
    control: box.dataset.control ?? "",
    default: box.dataset.default ?? "",
    required: box.dataset.required !== undefined,
    input: box.querySelector("input, select, textarea"),
  }));
}

/**
 * The text in a field as a JSON value; unreadable text is passed on, so that the server reports the violation.
 * @param {Field} field
 */
function valueOf(field) {
  const text = field.input.value.trim();
  switch (field.control) {
    case "boolean":
      return field.input.checked;
    case "number":
    case "integer":
      return text === "" ? text : readTyped(field).value ?? text;
    case "numbers":
      return readTyped(field).values ?? text;
    case "words":
      return text.split(/[\s,;]+/).filter(Boolean);
    case "json":
      try {
        return JSON.parse(text);
      } catch {
        return text;
      }
    default:
      return text;
  }
}

const ofAnAxis = /^(\/axes\/\d+)\/(from|to|values)$/;

/** Unit of the numbers in a field; on an axis of a sweep, that of the input that varies. @param {Field} field */
function unitOf(field) {
  const axis = field.pointer.match(ofAnAxis)?.[1];
  if (!axis) return field.unit;
  const form = field.box.closest("form");
  const pointerInput = /** @type {HTMLInputElement | null | undefined} */ (form?.querySelector(`[data-pointer='${axis}/pointer'] input`));
  const varied = pointerInput?.value.trim() ?? "";
  const boxes = /** @type {HTMLElement[]} */ ([...(form?.querySelectorAll("[data-pointer]") ?? [])]);
  const box = boxes.find(({ dataset }) => dataset.pointer === varied);
  return box?.dataset.unit ?? pointerLabel(varied).unit;
}

/**
 * The numbers typed into a field, or the reason why they are refused.
 * @param {Field} field
 * @returns {{ value?: number, values?: (number | string)[], refused?: string }}
 */
function readTyped(field) {
  const text = field.input.value;
  if (text.trim() === "") return {};
  if (field.control === "numbers") return readList(text, unitOf(field));
  if (field.control === "number" || field.control === "integer") return readField(text, unitOf(field));
  return {};
}

/** Reason why the numbers typed into a field are refused; null if they are accepted. @param {Field} field */
export const refusalOf = (field) => readTyped(field).refused ?? null;

/** Interpretation of the numbers typed into a field as text; empty if it equals the text. @param {Field} field */
export function readingOf(field) {
  const text = field.input.value.trim();
  const { value, values } = readTyped(field);
  if (values?.every((one) => typeof one === "number")) return values.join(", ") === text ? "" : values.join("; ");
  return value === undefined || (/^[+-]?[\d.]+(e[+-]?\d+)?$/i.test(text) && Number(text) === value) ? "" : String(value);
}

/** Whether a field has its default. @param {Field} field */
export function isDefault(field) {
  if (field.control === "boolean") return String(field.input.checked) === field.default;
  const text = field.input.value.trim();
  if (text === "" || (field.control === "list" && text === "0")) return true;
  if (field.required || field.default === "") return false;
  if (field.control === "number" || field.control === "integer") return readTyped(field).value === Number(field.default);
  return text === field.default;
}

/** The document of a pair of which nothing is given yet. @type {() => JobInput} */
export const emptyDocument = () => ({ design: { pinion: {}, gear: {} }, operation: {} });

/** Text of a field, as it stands in its input. @param {Field} field */
export const textOf = ({ control, input }) => (control === "boolean" ? String(input.checked) : input.value.trim());

/** Text that a field has for a document. @param {Field} field @param {JobInput} document */
export function textIn(field, document) {
  const value = get(document, field.pointer) ?? null;
  if (field.control === "parts") return partsOf(value);
  if (field.control === "list") return String(Array.isArray(value) ? value.length : 0);
  return field.control === "boolean" ? String(value ?? field.default === "true") : asText(field, value);
}

/** Puts a text into a field. @param {Field} field @param {string} text */
export function putText(field, text) {
  if (field.control === "boolean") field.input.checked = text === "true";
  else field.input.value = text;
}

/** Whether two texts of a field mean the same. @param {Field} field @param {string} one @param {string} other */
export function isSame(field, one, other) {
  if (one === other) return true;
  if (field.control === "words") return one.split(/[\s,;]+/).join() === other.split(/[\s,;]+/).join();
  if (one === "" || other === "") return false;
  const unit = unitOf(field);
  if (field.control === "numbers") {
    const values = readList(one, unit).values;
    return values !== undefined && values.join() === readList(other, unit).values?.join();
  }
  if (field.control !== "number" && field.control !== "integer") return false;
  const { value } = readField(one, unit);
  return value !== undefined && value === readField(other, unit).value;
}

/**
 * Objects in an object that a choice stands for: a member of `parts` for each.
 * @type {Record<string, string[]>}
 */
const PARTS = { arrangement: ["arrangement"], pinion: ["arrangement", "pinion"], gear: ["arrangement", "gear"], given: ["pinion", "gear"] };

/** The choice that an object of the document stands for. @param {any} value */
function partsOf(value) {
  if (typeof value !== "object" || value === null) return "";
  const given = ["pinion", "gear"].filter((name) => typeof value[name] === "object" && value[name] !== null);
  return given.length === 2 ? "given" : given[0] ?? "arrangement";
}

/** Members of documents without a field in the form: kept, so that the server reports the violations. */
const extras = new Map();

/** The job document of the form; fields with their default are left out. @param {HTMLElement} form */
export function readDocument(form) {
  /** @type {JobInput} */
  const root = {};
  const used = fieldsOf(form).filter(({ box }) => !box.hidden);
  for (const field of used) {
    if (field.control !== "list" && field.control !== "parts" && !isDefault(field)) put(root, field.pointer, valueOf(field));
  }
  // What is chosen or counted is there, even with every field in it at its default.
  for (const { control, pointer, input, box } of used) {
    const members = control === "parts" ? PARTS[input.value] ?? [] : control === "list" ? Array.from({ length: countAt(box) }, (_, index) => String(index)) : [];
    for (const member of members) if (get(root, `${pointer}/${member}`) === undefined) put(root, `${pointer}/${member}`, {});
  }
  // The second axis without the first: the document has no gaps.
  if (root.axes) root.axes = root.axes.filter(Boolean);
  // These are required, even when every field in them has been emptied.
  for (const pointer of ["/design", "/design/pinion", "/design/gear", "/operation"]) {
    if (get(root, pointer) === undefined) put(root, pointer, {});
  }
  for (const [pointer, value] of extras) put(root, pointer, value);
  return root;
}

/**
 * Fills the form from a document. Members without a field are kept for the documents read later.
 * @param {HTMLElement} form
 * @param {JobInput} document
 */
export function writeDocument(form, document) {
  fillLists(form, (pointer) => {
    const list = get(document, pointer);
    return Array.isArray(list) ? list.length : 0;
  });
  const known = new Set();
  /** Of these, the members have fields of their own. @type {Set<string>} */
  const holders = new Set();
  for (const field of fieldsOf(form)) {
    if (field.control === "list" || field.control === "parts") holders.add(field.pointer);
    known.add(field.pointer);
    putText(field, textIn(field, document));
  }
  extras.clear();
  const places = [...known];
  for (const [pointer, value] of leavesOf(document)) {
    const hasField = places.some((place) => pointer === place || (!holders.has(place) && pointer.startsWith(`${place}/`)));
    const isEmptyGroup = typeof value === "object" && places.some((place) => place.startsWith(`${pointer}/`));
    if (!hasField && !isEmptyGroup) extras.set(pointer, value);
  }
}

/** Pointers of the members that are kept without a field. */
export const extraPointers = () => [...extras.keys()];

/**
 * Puts a list without fields into the document, in place of what was there; nothing for an empty one.
 * @param {string} pointer @param {any[]} value
 */
export function setExtra(pointer, value) {
  for (const place of extras.keys()) if (place === pointer || place.startsWith(`${pointer}/`)) extras.delete(place);
  if (value.length) for (const [place, leaf] of leavesOf(value, pointer)) extras.set(place, leaf);
}

export const dropExtras = () => extras.clear();

function asText(field, value) {
  if (value === null) return field.default;
  if (field.control === "json") return JSON.stringify(value);
  if (Array.isArray(value)) return value.map((item) => (typeof item === "object" ? JSON.stringify(item) : item)).join(", ");
  return typeof value === "object" ? JSON.stringify(value) : String(value);
}

/** Pointer and value of all that is not null; of an empty object or list, itself. */
function leavesOf(value, pointer = "") {
  if (value === null) return [];
  if (typeof value !== "object" || (pointer && Object.keys(value).length === 0)) return [[pointer, value]];
  return Object.entries(value).flatMap(([name, inner]) => leavesOf(inner, `${pointer}/${escaped(name)}`));
}

// JSON pointers (RFC 6901).
const escaped = (name) => name.replaceAll("~", "~0").replaceAll("/", "~1");
const steps = (pointer) => pointer.split("/").slice(1).map((step) => step.replaceAll("~1", "/").replaceAll("~0", "~"));

function get(root, pointer) {
  return steps(pointer).reduce((value, step) => (value === null || value === undefined || !Object.hasOwn(Object(value), step) ? undefined : value[step]), root);
}

function put(root, pointer, value) {
  const path = steps(pointer);
  const last = path.pop();
  let place = root;
  path.forEach((step, index) => {
    const next = path[index + 1] ?? last;
    if (!Object.hasOwn(place, step) || typeof place[step] !== "object") set(place, step, /^\d+$/.test(next) ? [] : {});
    place = place[step];
  });
  set(place, last, value);
}

/** Sets a member of its own, whatever its name. */
function set(place, name, value) {
  Object.defineProperty(place, name, { value, writable: true, enumerable: true, configurable: true });
}

/** Shows the fields whose conditions hold; hidden fields do not count. @param {HTMLElement} form */
export function applyConditions(form) {
  const fields = fieldsOf(form);
  for (const { box } of fields) {
    if (box.dataset.when === undefined) continue;
    const other = fields.find((field) => field.pointer === box.dataset.when);
    box.hidden = !other || other.box.hidden || !(box.dataset.whenValues ?? "").split(" ").includes(other.input.value);
  }
  for (const block of /** @type {NodeListOf<HTMLElement>} */ (form.querySelectorAll(".block, .group"))) {
    const boxes = [.../** @type {NodeListOf<HTMLElement>} */ (block.querySelectorAll("[data-pointer]"))];
    block.hidden = boxes.length > 0 && boxes.every((box) => box.hidden);
  }
  byId("to-sweep").hidden = byAnyId("group-sweep").hidden;
}

/**
 * The field of a pointer in an answer: itself, the nearest around it, or the first in it.
 * @param {Field[]} fields
 * @param {string} pointer
 */
export function fieldAt(fields, pointer) {
  for (let place = pointer; place; place = place.slice(0, place.lastIndexOf("/"))) {
    const field = fields.find((field) => field.pointer === place && !field.box.hidden);
    if (field) return field;
  }
  return fields.find((field) => pointer && field.pointer.startsWith(`${pointer}/`) && !field.box.hidden) ?? null;
}
