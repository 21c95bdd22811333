// The inputs that differ, by JSON pointer over the documents as they are stored, every default filled in.

import { number, pointerLabel } from "../common/format.js";

/** JSON pointers of what names a job, or the point of a sweep that it repeats: they do not affect its result. */
const NAMES = ["/name", "/label"];
const ORIGIN = "/sweep_point/";
const PER_HALF = ["tip_relief", "lead_crowning_um", "helix_slope_um", "end_relief"];

/**
 * Rows { pointer, label, unit, values } of the inputs that are not the same in all documents, and how many there are
 * in all.
 */
export function differing(documents) {
  const flat = documents.map((document) => leaves(withHalves(document)));
  const pointers = [...new Set(flat.flatMap((leaf) => [...leaf.keys()]))].filter((pointer) => !NAMES.includes(pointer) && !pointer.startsWith(ORIGIN));
  const merged = pointers.filter((pointer) => !isHalf(pointer) || flat.some((leaf) => !same(leaf.get(pointer), leaf.get(otherHalf(pointer)))));
  const kept = merged.concat(bothHalves(pointers.filter((pointer) => !merged.includes(pointer))));
  const valueOf = (leaf, pointer) => (leaf.has(pointer) ? leaf.get(pointer) : leaf.get(pointer.replace(...BOTH)));
  // A derived input (null) and one that this kind of job does not have (absent) count as equal.
  const given = (value) => value ?? null;
  const rows = kept
    .map((pointer) => ({ pointer, values: flat.map((leaf) => valueOf(leaf, pointer)) }))
    .filter(({ values }) => values.some((value) => !same(given(value), given(values[0]))))
    .map((row) => ({ ...row, ...labelOf(row.pointer) }));
  return { rows, total: kept.length };
}

/** Flank modifications of each half: those that a half does not state are those of its gear. */
function withHalves(document) {
  const design = { ...document.design };
  for (const member of ["pinion", "gear"]) {
    const { left, right, ...rest } = design[member] ?? {};
    const halves = [left, right].map((half) => Object.fromEntries(PER_HALF.map((name) => [name, half?.[name] ?? rest[name]])));
    for (const name of PER_HALF) delete rest[name];
    design[member] = { ...rest, left: halves[0], right: halves[1] };
  }
  return { ...document, design };
}

const HALF = /^(\/design\/(?:pinion|gear))\/(left|right)\//;
/** From the pointer of both halves to that of the left one, which then stands for both. */
const BOTH = [/^(\/design\/(?:pinion|gear))\/(tip_relief|lead_crowning_um|helix_slope_um|end_relief)/, "$1/left/$2"];
const isHalf = (pointer) => HALF.test(pointer);
const otherHalf = (pointer) => pointer.replace(HALF, (_, member, half) => `${member}/${half === "left" ? "right" : "left"}/`);
const bothHalves = (pointers) => [...new Set(pointers.map((pointer) => pointer.replace(HALF, "$1/")))];

/** Pointer and value of every leaf; lists count as one value. */
function leaves(value, pointer = "", into = new Map()) {
  if (value !== null && typeof value === "object" && !Array.isArray(value)) {
    for (const [name, inner] of Object.entries(value)) leaves(inner, `${pointer}/${name}`, into);
  } else if (pointer === "/axes") {
    (value ?? []).forEach((axis, index) => into.set(`/axes/${index}`, axis));
  } else if (value !== undefined) {
    into.set(pointer, value);
  }
  return into;
}

const same = (a, b) => JSON.stringify(a) === JSON.stringify(b);

function labelOf(pointer) {
  const axis = /^\/axes\/(\d)$/.exec(pointer);
  return axis ? { label: `Varied input ${Number(axis[1]) + 1}`, unit: "" } : pointerLabel(pointer);
}

/** An input as text; null is a derived input, undefined one that the document does not have. */
export function shown(value) {
  if (value === undefined) return "–";
  if (value === null) return "auto";
  if (typeof value === "number") return number(value, 7);
  if (typeof value === "boolean") return value ? "yes" : "no";
  if (typeof value === "string") return value.replaceAll("_", " ");
  if (value.pointer) return axisText(value);
  return listText(value);
}

function axisText({ pointer, from, to, points, spacing, values }) {
  const { label, unit } = pointerLabel(pointer);
  const range = values?.length ? listText(values) : `${number(from)} … ${number(to)}${unit ? ` ${unit}` : ""}, ${points} points, ${spacing ?? "linear"}`;
  return `${label}: ${range}`;
}

function listText(list) {
  const text = list.map((entry) => (typeof entry === "number" ? number(entry) : typeof entry === "string" ? entry : JSON.stringify(entry))).join(", ");
  return text.length <= 60 ? text : `${list.length} values: ${text.slice(0, 40)}…`;
}
