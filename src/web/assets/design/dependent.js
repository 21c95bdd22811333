// Values that depend on the geometry: the derived value in an empty field, and marks on values that were entered for
// another geometry. All of them are calculated by the server.

import { el } from "../common/dom.js";
import { number, shownUnit } from "../common/format.js";
import { fieldsOf, isDefault, isSame, putText, textIn, textOf } from "./document.js";
import { say } from "./errors.js";

/** @typedef {import("./document.js").Field} Field */
/** @typedef {CheckedDocument["derived"][number]} Derived */
/** @typedef {import("./draft.js").Entered} Entered */

/** Relative difference up to which two derived values are of the same geometry. */
const SAME_GEOMETRY = 1e-6;

/**
 * Sets the marks up; `changed` is called after a value was replaced or kept.
 * @param {HTMLFormElement} form
 * @param {() => void} changed
 */
export function initDependent(form, changed) {
  /** @type {Map<string, Derived>} */
  let derived = new Map();
  /** @type {Map<string, { text: string, derived: number }>} */
  let entered = new Map();

  /** @param {Field} field */
  const ownText = (field) => (field.box.hidden || isDefault(field) ? "" : textOf(field));

  /** @param {Field} field */
  function isStale(field) {
    const [now, then] = [derived.get(field.pointer), entered.get(field.pointer)];
    if (!now || !then || ownText(field) === "" || !isSame(field, textOf(field), then.text)) return false;
    return Math.abs(now.value - then.derived) > SAME_GEOMETRY * Math.abs(then.derived);
  }

  const fields = () => fieldsOf(form).filter(({ pointer }) => derived.has(pointer));
  const stale = () => fields().filter(isStale);

  /**
   * The values of a document belong to the geometry of these derived values.
   * @param {JobInput} document
   * @param {Derived[]} list
   */
  function settle(document, list) {
    const values = new Map(list.map((one) => [one.pointer, one.value]));
    for (const field of fieldsOf(form)) {
      const [value, text] = [values.get(field.pointer), textIn(field, document)];
      if (value !== undefined && text !== field.default && !entered.has(field.pointer)) entered.set(field.pointer, { text, derived: value });
    }
  }

  /** Shows the derived values of a document that was checked. @param {Derived[]} list */
  function update(list) {
    derived = new Map(list.map((one) => [one.pointer, one]));
    for (const field of fields()) {
      const now = /** @type {Derived} */ (derived.get(field.pointer));
      const [text, then] = [ownText(field), entered.get(field.pointer)];
      if (text === "") entered.delete(field.pointer);
      else if (!then || !isSame(field, text, then.text)) entered.set(field.pointer, { text, derived: now.value });
      show(field, now);
    }
  }

  /** @param {Field} field @param {Derived} now */
  function show(field, { value, unit, basis, is_default: isItsDefault }) {
    const shown = number(value, 4);
    if (isItsDefault) {
      field.input.placeholder = `derived: ${shown}`;
      field.box.dataset.basis = basis;
    }
    const marked = isStale(field);
    field.box.classList.toggle("of-other-geometry", marked);
    const what = [shown, shownUnit(unit)].filter(Boolean).join(" ");
    const button = (text, action) => el("button", { type: "button", class: "quiet", "aria-label": `${field.label}: ${text}`, "data-action": action }, text);
    if (marked && isItsDefault) say(field, "stale", [`entered for another geometry; this one gives ${what} `, button("Use derived", "use"), " ", button("Keep", "keep")]);
    else if (marked) say(field, "stale", [`entered for another geometry; practice for this one: ${what} `, button(`Use ${shown}`, "use"), " ", button("Keep", "keep")]);
    else say(field, "stale", isItsDefault || ownText(field) !== "" || field.box.hidden ? [] : [`the default; practice for this size: ${what} `, button(`Use ${shown}`, "use")]);
  }

  /** @param {Field} field */
  function use(field) {
    const now = derived.get(field.pointer);
    if (now) putText(field, now.is_default ? "" : String(now.value));
    entered.delete(field.pointer);
  }

  /** @param {Field} field */
  function keep(field) {
    const now = derived.get(field.pointer);
    if (now) entered.set(field.pointer, { text: textOf(field), derived: now.value });
  }

  form.addEventListener("click", (event) => {
    const button = /** @type {HTMLElement | null} */ (/** @type {Element} */ (event.target).closest(".stale button"));
    const field = button && fields().find(({ box }) => box.contains(button));
    if (!field) return;
    if (button.dataset.action === "use") use(field);
    else keep(field);
    field.input.focus();
    changed();
  });

  return {
    settle,
    update,
    stale,
    useAll: () => stale().forEach(use),
    keepAll: () => stale().forEach(keep),
    /** The form was filled anew, with these entries where they are known. @param {Entered} [known] */
    reset(known = {}) {
      entered = new Map(Object.entries(known));
      for (const field of fieldsOf(form)) {
        say(field, "stale", []);
        field.box.classList.remove("of-other-geometry");
      }
    },
    /** The document cannot be checked: what stands in the fields would be of another pair. */
    fade() {
      for (const { box, input } of fields()) {
        if (input.placeholder) input.placeholder = "derived";
        delete box.dataset.basis;
      }
    },
    /** @returns {Entered} */
    entered: () => Object.fromEntries(entered),
  };
}
