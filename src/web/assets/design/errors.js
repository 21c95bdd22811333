// Violations and warnings in answers of the server, shown at the fields they are about.

import { byId, el, show } from "../common/dom.js";
import { fieldAt, fieldsOf, readingOf, refusalOf } from "./document.js";

/** @param {HTMLElement} form */
export function clearErrors(form) {
  for (const field of fieldsOf(form)) {
    say(field, "error", "");
    say(field, "caution", "");
    field.input.removeAttribute("aria-invalid");
  }
  show(byId("problems"), false);
}

/** Says below each field how its numbers are read, where that differs from the text. @param {HTMLElement} form */
export function showReadings(form) {
  for (const field of fieldsOf(form)) {
    if (!["number", "integer", "numbers"].includes(field.control)) continue;
    const read = field.box.hidden ? "" : readingOf(field);
    say(field, "read", read ? `read as ${read}` : "");
  }
}

/** Marks the fields that warnings are about. @param {HTMLElement} form @param {WarningEntry[]} warnings */
export function showWarnings(form, warnings) {
  const fields = fieldsOf(form);
  for (const { pointer, detail } of warnings) {
    const field = fieldAt(fields, pointer ?? "");
    if (field) say(field, "caution", detail, { add: true });
  }
}

/**
 * Marks the fields named in the error; `summary` also lists everything at the top and goes there.
 * @param {HTMLElement} form
 * @param {any} error
 * @param {{ summary: boolean }} options
 */
export function showErrors(form, error, { summary }) {
  clearErrors(form);
  const fields = fieldsOf(form);
  /** @type {Violation[]} */
  const violations = error.errors ?? [];
  const entries = violations.map((entry) => {
    const field = fieldAt(fields, entry.pointer ?? "");
    // Refused numbers were sent as text; the form's own message states the reason.
    const refused = field?.pointer === entry.pointer ? refusalOf(field) : null;
    return { ...entry, field, detail: refused ?? entry.detail };
  });
  for (const { field, pointer, detail } of entries) {
    if (!field) continue;
    const place = pointer.startsWith(`${field.pointer}/`) ? `${pointer.slice(field.pointer.length + 1)}: ` : "";
    say(field, "error", `${place}${detail}`, { add: true });
    field.input.setAttribute("aria-invalid", "true");
    unfold(field);
  }
  const nowhere = entries.filter(({ field }) => !field);
  if (summary || nowhere.length || entries.length === 0) {
    listProblems(error, summary ? entries : nowhere);
    if (summary) byId("problems").focus();
  }
}

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

/** @typedef {import("./document.js").Field} Field */

/**
 * @param {Field} field
 * @param {string} kind class of the text
 * @param {string} text
 * @param {{ add?: boolean }} [options]
 */
function say(field, kind, text, { add = false } = {}) {
  const node = field.box.querySelector(`.${kind}`);
  if (!node) return;
  node.textContent = add && node.textContent ? `${node.textContent}; ${text}` : text;
}

/** @param {any} error @param {{ field: Field | null, pointer: string, detail: string }[]} entries */
function listProblems(error, entries) {
  const box = byId("problems");
  const items = entries.map(({ field, pointer, detail }) => {
    const text = [pointer, detail].filter(Boolean).join(" ");
    if (!field) return el("li", {}, text);
    return el("li", {}, linkTo(field), ` ${detail}`);
  });
  box.replaceChildren(
    el("strong", {}, error.problem?.title ?? error.message),
    error.problem?.detail ? ` ${error.problem.detail}` : "",
    items.length ? el("ul", {}, ...items) : "",
  );
  show(box);
}
