// Between the form and the job document: which value each field has, and where in the document it stands.

import { pointerLabel } from "../common/format.js";
import { readField, readList } from "./typed.js";

/** The fields of the form, in order. */
export function fieldsOf(form) {
  return [...form.querySelectorAll("[data-pointer]")].map((box) => ({
    box,
    pointer: box.dataset.pointer,
    label: box.querySelector("label").firstChild.textContent.trim(),
    /** What fields of pinion and gear share a row for. */
    row: box.dataset.row,
    unit: box.dataset.unit ?? "",
    control: box.dataset.control,
    default: box.dataset.default,
    required: box.dataset.required !== undefined,
    input: box.querySelector("input, select, textarea"),
  }));
}

/** The text in a field as a JSON value; what cannot be read goes in as text, for the server to say what is wrong. */
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

/** What the numbers in a field are in; on an axis of a sweep, the unit of the input that varies. */
function unitOf(field) {
  const axis = field.pointer.match(ofAnAxis)?.[1];
  if (!axis) return field.unit;
  const form = field.box.closest("form");
  const varied = form.querySelector(`[data-pointer='${axis}/pointer'] input`)?.value.trim() ?? "";
  const box = [...form.querySelectorAll("[data-pointer]")].find(({ dataset }) => dataset.pointer === varied);
  return box?.dataset.unit ?? pointerLabel(varied).unit;
}

/** The numbers typed into a field: { value } or { values }, or { refused } with the reason. */
function readTyped(field) {
  const text = field.input.value;
  if (text.trim() === "") return {};
  if (field.control === "numbers") return readList(text, unitOf(field));
  if (field.control === "number" || field.control === "integer") return readField(text, unitOf(field));
  return {};
}

/** Why the numbers typed into a field are not taken, if they are not. */
export const refusalOf = (field) => readTyped(field).refused ?? null;

/** How the numbers typed into a field are read, where that is not what stands there. */
export function readingOf(field) {
  const text = field.input.value.trim();
  const { value, values } = readTyped(field);
  if (values?.every((one) => typeof one === "number")) return values.join(", ") === text ? "" : values.join("; ");
  return value === undefined || (/^[+-]?[\d.]+(e[+-]?\d+)?$/i.test(text) && Number(text) === value) ? "" : String(value);
}

/** Whether a field says what leaving it out says. */
export function isDefault(field) {
  if (field.control === "boolean") return String(field.input.checked) === field.default;
  const text = field.input.value.trim();
  if (text === "") return true;
  if (field.required || field.default === "") return false;
  if (field.control === "number" || field.control === "integer") return readTyped(field).value === Number(field.default);
  return text === field.default;
}

/** What documents had that the form has no field for: kept, so that the server says what is wrong with it. */
const extras = new Map();

/** The job document that the form describes; what has its default is left out. */
export function readDocument(form) {
  const root = {};
  for (const field of fieldsOf(form)) {
    if (!field.box.hidden && !isDefault(field)) put(root, field.pointer, valueOf(field));
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

/** Fills the form from a document. What has no place in it is kept for the documents read later. */
export function writeDocument(form, document) {
  const known = new Set();
  for (const field of fieldsOf(form)) {
    known.add(field.pointer);
    const value = get(document, field.pointer);
    if (field.control === "boolean") field.input.checked = (value ?? field.default === "true") === true;
    else field.input.value = asText(field, value ?? null);
  }
  extras.clear();
  const places = [...known];
  for (const [pointer, value] of leavesOf(document)) {
    const hasField = places.some((place) => pointer === place || pointer.startsWith(`${place}/`));
    const isEmptyGroup = typeof value === "object" && places.some((place) => place.startsWith(`${pointer}/`));
    if (!hasField && !isEmptyGroup) extras.set(pointer, value);
  }
}

/** Pointers of what is kept though the form has no field for it. */
export const extraPointers = () => [...extras.keys()];

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

/** Shows the fields whose conditions hold; hidden fields do not count. */
export function applyConditions(form) {
  const fields = fieldsOf(form);
  for (const { box } of fields) {
    if (box.dataset.when === undefined) continue;
    const other = fields.find((field) => field.pointer === box.dataset.when);
    box.hidden = !other || other.box.hidden || !box.dataset.whenValues.split(" ").includes(other.input.value);
  }
  for (const block of form.querySelectorAll(".block, .group")) {
    const boxes = [...block.querySelectorAll("[data-pointer]")];
    block.hidden = boxes.length > 0 && boxes.every((box) => box.hidden);
  }
  document.getElementById("to-sweep").hidden = document.getElementById("group-sweep").hidden;
}

/** The field that a pointer of the server's is about: itself, the nearest around it, or the first in it. */
export function fieldAt(fields, pointer) {
  for (let place = pointer; place; place = place.slice(0, place.lastIndexOf("/"))) {
    const field = fields.find((field) => field.pointer === place && !field.box.hidden);
    if (field) return field;
  }
  return fields.find((field) => pointer && field.pointer.startsWith(`${pointer}/`) && !field.box.hidden) ?? null;
}
