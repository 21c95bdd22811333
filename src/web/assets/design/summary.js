// Fields that differ from their defaults: a reset beside each, and a line in each section's heading.

import { fieldsOf, isDefault } from "./document.js";

const MOST = 4;

/** Resets of single fields; `changed` is called after one. @param {HTMLElement} form @param {() => void} changed */
export function initResets(form, changed) {
  form.addEventListener("click", (event) => {
    const button = /** @type {Element} */ (event.target).closest(".reset");
    if (!button) return;
    const field = fieldsOf(form).find(({ box }) => box.contains(button));
    if (!field) return;
    if (field.control === "boolean") field.input.checked = field.default === "true";
    else field.input.value = field.default;
    field.input.focus();
    changed();
  });
}

/** Marks the fields that differ from their default, and lists them in the headings. @param {HTMLElement} form */
export function showWhatIsSet(form) {
  const fields = fieldsOf(form);
  const visible = new Map();
  for (const field of fields) {
    const changed = !field.box.hidden && !isDefault(field);
    field.box.classList.toggle("differs", changed && !field.required);
    visible.set(field.box, changed);
  }
  for (const section of form.querySelectorAll("details.group")) {
    const gist = /** @type {HTMLElement} */ (section.querySelector(".gist"));
    const changed = fields.filter((field) => section.contains(field.box) && visible.get(field.box));
    gist.textContent = changed.length ? gistOf(changed) : (gist.dataset.nothing ?? "");
  }
}

/**
 * "Teeth 17 / 44, normal module 6 mm": fields of pinion and gear with the same name share an entry.
 * @param {Field[]} fields
 */
function gistOf(fields) {
  const entries = new Map();
  for (const field of fields) {
    const name = field.row ?? field.label;
    const entry = entries.get(name) ?? { values: [], unit: field.unit };
    entry.values.push(valueText(field));
    entries.set(name, entry);
  }
  const texts = [...entries].map(([name, { values, unit }], index) => {
    const label = index ? name.charAt(0).toLowerCase() + name.slice(1) : name;
    return `${label} ${values.join(" / ")}${unit ? ` ${unit}` : ""}`;
  });
  const more = texts.length - MOST;
  return texts.slice(0, MOST).join(", ") + (more > 0 ? ` and ${more} more` : "");
}

/** @typedef {import("./document.js").Field} Field */

/** @param {Field} field */
function valueText({ control, input }) {
  if (control === "boolean") return input.checked ? "yes" : "no";
  if (control === "choice") return input.selectedOptions[0]?.textContent ?? "";
  const text = input.value.trim();
  return text.length > 24 ? `${text.slice(0, 23)}…` : text;
}
