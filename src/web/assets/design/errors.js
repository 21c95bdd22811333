// Violations and warnings in answers of the server, shown at the fields they are about, and the list of all of them.

import { byId, el, show } from "../common/dom.js";
import { codeWords, FIELD_NAME, placeOf, readable, withUnits, withValue } from "../common/sentence.js";
import { fieldAt, fieldsOf, readingOf, refusalOf, textOf } from "./document.js";

/** @typedef {import("./document.js").Field} Field */
/**
 * A violation with its field. `todo`: a required field that nobody has touched yet.
 * @typedef {{ field: Field | null, pointer: string, code: string, detail: string, todo: boolean }} Entry
 */

/** Violations of a field by itself; the others are of rules between fields. */
const OF_ONE_FIELD = ["missing", "unknown-field", "wrong-type", "out-of-range", "not-one-of", "too-long", "further"];

/** Fields that were edited since the form was filled. @type {Set<string>} */
const touched = new Set();
/** The field edited last. @type {string | null} */
let editedLast = null;
/** Whether required fields that are empty are errors: once the document was to be submitted. */
let isStrict = false;
/** Violations that are shown already: their sections may be closed again. @type {Set<string>} */
let shown = new Set();
/** For each violation of a rule, the field whose edit brought it about. @type {Map<string, string | null>} */
const broughtAbout = new Map();

/** @param {string} pointer */
export function noteEdit(pointer) {
  touched.add(pointer);
  editedLast = pointer;
}

/** The form was filled anew: nothing is edited. */
export function forgetEdits() {
  touched.clear();
  editedLast = null;
  isStrict = false;
  shown.clear();
  broughtAbout.clear();
}

/** From now on required fields that are empty are errors. */
export function requireAll() {
  isStrict = true;
}

/**
 * Takes all errors and cautions away; `isGood` where nothing is wrong.
 * @param {HTMLElement} form
 * @param {boolean} [isGood]
 */
export function clearErrors(form, isGood = true) {
  if (isGood) {
    shown.clear();
    broughtAbout.clear();
  }
  for (const field of fieldsOf(form)) {
    say(field, "error", []);
    say(field, "caution", []);
    field.input.removeAttribute("aria-invalid");
  }
  show(byId("problems"), false);
}

/**
 * Says below each field how its numbers are read, where that differs from the text, and what an empty one stands for.
 * @param {HTMLElement} form
 */
export function showReadings(form) {
  for (const field of fieldsOf(form)) {
    if (!["number", "integer", "numbers"].includes(field.control)) continue;
    const read = field.box.hidden ? "" : readingOf(field);
    const basis = textOf(field) === "" ? field.box.dataset.basis : undefined;
    say(field, "read", [read ? `read as ${read}` : basis]);
  }
}

/** Warnings of derived values, which the fields themselves show. */
const SHOWN_IN_THE_FIELD = ["bore-assumed", "assumed-inertia", "assumed-mass", "assumed-supports"];

/** Whether a warning is of a derived value that its field shows. @param {WarningEntry} warning */
export const isOfADerivedValue = ({ code }) => SHOWN_IN_THE_FIELD.includes(code);

/** Marks the fields that warnings are about. @param {HTMLElement} form @param {WarningEntry[]} warnings */
export function showWarnings(form, warnings) {
  const fields = fieldsOf(form);
  for (const { code, pointer, detail } of warnings.filter((warning) => !isOfADerivedValue(warning))) {
    const field = fieldAt(fields, pointer ?? "");
    if (!field) continue;
    // In a few words, so that nothing moves; in full where one looks, and in the list of warnings.
    const short = el("span", { class: "short", "aria-hidden": "true" }, codeWords(code));
    say(field, "caution", [short, el("span", { class: "full" }, ...sentenceOf(detail, fields, field))], { add: true });
  }
}

/** Warnings in full, with links to their fields. @param {HTMLElement} form @param {WarningEntry[]} warnings */
export function warningItems(form, warnings) {
  const fields = fieldsOf(form);
  return warnings.map(({ code, detail, pointer }) => {
    const field = fieldAt(fields, pointer ?? "");
    const place = field ? linkTo(field) : placeOf(pointer);
    return el("li", {}, el("strong", {}, codeWords(code)), " ", ...sentenceOf(detail, fields, field), ". ", place);
  });
}

/**
 * The violations of an error with their fields.
 * @param {HTMLElement} form @param {any} error @returns {Entry[]}
 */
function entriesOf(form, error) {
  const fields = fieldsOf(form);
  /** @type {Violation[]} */
  const violations = error.errors ?? [];
  const place = ({ field }) => (field ? fields.indexOf(field) : -1);
  return violations.map(({ pointer = "", code, detail }) => {
    const field = fieldAt(fields, pointer);
    const isOwn = field?.pointer === pointer;
    // Refused numbers were sent as text; the form's own message states the reason.
    const refused = field && isOwn ? refusalOf(field) : null;
    const todo = Boolean(field && isOwn && code === "missing" && field.required && textOf(field) === "" && !isStrict && !touched.has(pointer));
    return { field, pointer, code, todo, detail: refused ?? (field && isOwn ? notANumber(field, code) : null) ?? detail };
  }).toSorted((a, b) => place(a) - place(b));
}

/** @param {Field} field @param {string} code */
function notANumber(field, code) {
  if (code !== "wrong-type" || !["number", "integer"].includes(field.control) || readingOf(field) || Number.isFinite(Number(textOf(field)))) return null;
  return `“${textOf(field)}” is not a number`;
}

/**
 * Marks the fields named in the error, and the field edited last where a rule between fields is broken; `summary` also
 * lists everything at the top and goes there.
 * @param {HTMLElement} form
 * @param {any} error
 * @param {{ summary: boolean }} options
 * @returns {Entry[]}
 */
export function showErrors(form, error, { summary }) {
  clearErrors(form, false);
  const fields = fieldsOf(form);
  const entries = entriesOf(form, error);
  const blamed = blameOf(entries);
  const before = shown;
  shown = new Set(entries.filter(({ todo }) => !todo).map(keyOf));
  for (const entry of entries) {
    const { field, pointer, detail } = entry;
    if (!field || entry.todo) continue;
    const inside = pointer.startsWith(`${field.pointer}/`) ? `${placeOf(pointer.slice(field.pointer.length))}: ` : "";
    mark(field, [inside, ...sentenceOf(detail, fields, field)]);
    if (summary || !before.has(keyOf(entry))) unfold(field);
    const cause = fields.find((other) => other.pointer === blamed.get(entry) && !other.box.hidden && !entries.some(({ pointer: own }) => own === other.pointer));
    if (cause) mark(cause, ["with this value, ", linkTo(field), " ", ...sentenceOf(detail, fields, field)]);
  }
  const nowhere = entries.filter(({ field }) => !field);
  if (summary || nowhere.length || entries.length === 0) {
    listProblems(form, error, summary ? entries : nowhere);
    if (summary) byId("problems").focus();
  }
  return entries;
}

/** @param {Field} field @param {Child[]} sentence */
function mark(field, sentence) {
  say(field, "error", sentence, { add: true });
  field.input.setAttribute("aria-invalid", "true");
}

/** @param {Entry} entry */
const keyOf = ({ pointer, code }) => `${pointer} ${code}`;

/**
 * For each broken rule the field whose edit broke it, where that is another than the one that the server names.
 * @param {Entry[]} entries
 */
function blameOf(entries) {
  const rules = entries.filter(({ field, code }) => field && !OF_ONE_FIELD.includes(code));
  const keys = rules.map(keyOf);
  for (const key of broughtAbout.keys()) if (!keys.includes(key)) broughtAbout.delete(key);
  const blamed = new Map();
  for (const entry of rules) {
    const key = keyOf(entry);
    if (!broughtAbout.has(key) || editedLast === entry.field?.pointer) {
      broughtAbout.set(key, editedLast === entry.field?.pointer ? null : editedLast);
    }
    blamed.set(entry, broughtAbout.get(key));
  }
  return blamed;
}

/**
 * A sentence of the server with units as symbols, and names of fields as links to them.
 * @param {string} detail @param {Field[]} fields @param {Field | null} near the field that it is about
 * @returns {Child[]}
 */
export function sentenceOf(detail, fields, near) {
  const text = withUnits(detail);
  /** @type {Child[]} */
  const parts = [];
  let end = 0;
  for (const found of text.matchAll(FIELD_NAME)) {
    const [, name, value] = found;
    const named = fieldNamed(name, fields, near);
    parts.push(text.slice(end, found.index), named ? linkTo(named) : readable(name), withValue(name, value));
    end = found.index + found[0].length;
  }
  return [...parts, text.slice(end)];
}

/**
 * Another field with a name: of those with it, the one with the longest common beginning.
 * @param {string} name @param {Field[]} fields @param {Field | null} near
 */
function fieldNamed(name, fields, near) {
  const place = near?.pointer ?? "";
  const common = ({ pointer }) => [...pointer].findIndex((letter, index) => letter !== place[index]);
  const named = fields.filter(({ pointer, box }) => pointer.endsWith(`/${name}`) && pointer !== place && !box.hidden);
  return named.toSorted((a, b) => reach(common(b), b) - reach(common(a), a) || a.pointer.length - b.pointer.length)[0];
}

/** @param {number} at @param {Field} field */
const reach = (at, { pointer }) => (at < 0 ? pointer.length : at);

/** Opens the sections around a field. @param {Field} field */
function unfold(field) {
  for (let place = field.box.closest("details"); place; place = place.parentElement?.closest("details") ?? null) place.open = true;
}

/** A link to a field that opens the sections around it. @param {Field} field */
export function linkTo(field) {
  const link = el("a", { href: `#${field.input.id}` }, field.label);
  link.addEventListener("click", (event) => {
    event.preventDefault();
    unfold(field);
    field.input.focus();
  });
  return link;
}

/**
 * @param {Field} field
 * @param {string} kind class of the text
 * @param {Child[]} sentence
 * @param {{ add?: boolean }} [options]
 */
export function say(field, kind, sentence, { add = false } = {}) {
  const node = field.box.querySelector(`.${kind}`);
  if (!node) return;
  const parts = sentence.filter((part) => part !== "" && part !== null && part !== undefined).map((part) => (part instanceof Node ? part : String(part)));
  if (add && node.hasChildNodes()) node.append("; ", ...parts);
  else node.replaceChildren(...parts);
}

/** Items of a list of violations. @param {HTMLElement} form @param {Entry[]} entries */
export function problemItems(form, entries) {
  const fields = fieldsOf(form);
  return entries.map(({ field, pointer, detail, todo }) => {
    if (!field) return el("li", {}, [placeOf(pointer), readable(detail)].filter(Boolean).join(" "));
    return el("li", {}, linkTo(field), ...(todo ? [] : [" ", ...sentenceOf(detail, fields, field)]));
  });
}

/** @param {HTMLElement} form @param {any} error @param {Entry[]} entries */
function listProblems(form, error, entries) {
  const box = byId("problems");
  box.replaceChildren(
    el("strong", {}, error.problem?.title ?? error.message),
    error.problem?.detail ? ` ${readable(error.problem.detail)}` : "",
    entries.length ? el("ul", {}, ...problemItems(form, entries)) : "",
  );
  show(box);
}
