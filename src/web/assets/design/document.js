// Between the form and the job document: which value each field has, and where in the document it stands.

/** The fields of the form, in order. */
export function fieldsOf(form) {
  return [...form.querySelectorAll("[data-pointer]")].map((box) => ({
    box,
    pointer: box.dataset.pointer,
    control: box.dataset.control,
    default: box.dataset.default,
    required: box.dataset.required !== undefined,
    input: box.querySelector("input, select, textarea"),
    error: box.querySelector(".error"),
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
      return asNumber(text);
    case "numbers":
      return words(text).map(asNumber);
    case "words":
      return words(text);
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

const words = (text) => text.split(/[\s,;]+/).filter(Boolean);

function asNumber(text) {
  const value = Number(text);
  return text !== "" && Number.isFinite(value) ? value : text;
}

function isLeftOut(field) {
  if (field.box.hidden) return true;
  if (field.control === "boolean") return String(field.input.checked) === field.default;
  const text = field.input.value.trim();
  if (text === "") return true;
  if (field.required || field.default === "") return false;
  if (field.control === "number" || field.control === "integer") return Number(text) === Number(field.default);
  return text === field.default;
}

/** The job document that the form describes; what has its default is left out. */
export function readDocument(form) {
  const root = {};
  for (const field of fieldsOf(form)) {
    if (!isLeftOut(field)) put(root, field.pointer, valueOf(field));
  }
  // The second axis without the first: the document has no gaps.
  if (root.axes) root.axes = root.axes.filter(Boolean);
  // These are required, even when every field in them has been emptied.
  for (const pointer of ["/design", "/design/pinion", "/design/gear", "/operation"]) {
    if (get(root, pointer) === undefined) put(root, pointer, {});
  }
  return root;
}

/** Fills the form from a document. Returns the pointers of what has no place in it. */
export function writeDocument(form, document) {
  const known = new Set();
  for (const field of fieldsOf(form)) {
    known.add(field.pointer);
    const value = get(document, field.pointer);
    if (field.control === "boolean") field.input.checked = (value ?? field.default === "true") === true;
    else field.input.value = asText(field, value ?? null);
  }
  return leavesOf(document).filter((pointer) => ![...known].some((place) => pointer === place || pointer.startsWith(`${place}/`)));
}

function asText(field, value) {
  if (value === null) return field.default;
  if (field.control === "json") return JSON.stringify(value);
  if (Array.isArray(value)) return value.join(", ");
  return typeof value === "object" ? JSON.stringify(value) : String(value);
}

function leavesOf(value, pointer = "") {
  if (value === null) return [];
  if (typeof value !== "object") return [pointer];
  return Object.entries(value).flatMap(([name, inner]) => leavesOf(inner, `${pointer}/${name}`));
}

const steps = (pointer) => pointer.split("/").slice(1);

function get(root, pointer) {
  return steps(pointer).reduce((value, step) => (value === null || value === undefined ? undefined : value[step]), root);
}

function put(root, pointer, value) {
  const path = steps(pointer);
  const last = path.pop();
  let place = root;
  path.forEach((step, index) => {
    const next = path[index + 1] ?? last;
    place = place[step] ??= /^\d+$/.test(next) ? [] : {};
  });
  place[last] = value;
}

/** Shows the fields whose conditions hold; hidden fields do not count. */
export function applyConditions(form) {
  const fields = fieldsOf(form);
  for (const { box } of fields) {
    if (box.dataset.when === undefined) continue;
    const other = fields.find((field) => field.pointer === box.dataset.when);
    box.hidden = !box.dataset.whenValues.split(" ").includes(other?.input.value);
  }
  for (const block of form.querySelectorAll("fieldset, .group")) {
    block.hidden = [...block.querySelectorAll("[data-pointer]")].every((box) => box.hidden);
  }
}

/** The field that a pointer of the server's is about: itself, or the nearest around it. */
export function fieldAt(fields, pointer) {
  for (let place = pointer; place; place = place.slice(0, place.lastIndexOf("/"))) {
    const field = fields.find((field) => field.pointer === place && !field.box.hidden);
    if (field) return field;
  }
  return null;
}
