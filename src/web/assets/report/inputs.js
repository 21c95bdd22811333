// The inputs of a job by groups, with those that differ from the defaults.

import { labelOf, number, sentence, shownUnit, unitOf } from "../common/format.js";

const GROUPS = [
  ["Operating point", "/operation"], ["Gear", "/design"], ["Material", "/design/material"], ["Pinion", "/design/pinion"], ["Wheel", "/design/gear"], ["Supports", "/design/supports"],
  ["Arrangement of the shafts", "/design/shafts/arrangement"], ["Shaft of the pinion", "/design/shafts/pinion"], ["Shaft of the gear", "/design/shafts/gear"],
  ["Assembly errors", "/design/assembly"], ["Model", "/model"], ["Analysis", "/analysis"],
];

/**
 * Groups of rows; null inputs are derived and left out.
 * @typedef {{ label: string, value: string, unit: string, differs: boolean, usual: string | null, help: string }}
 * InputRow
 * @param {JobInput} input
 * @param {any} schema JSON Schema of the document's kind
 */
export function inputGroups(input, schema) {
  /** @type {Map<string, { title: string, rows: InputRow[] }>} */
  const groups = new Map(GROUPS.map(([title, pointer]) => [pointer, { title, rows: [] }]));
  walk(input, schema, "", (pointer, value, about) => {
    const home = [...groups.keys()].filter((key) => pointer.startsWith(`${key}/`)).sort((a, b) => b.length - a.length)[0];
    if (!home) return;
    const steps = pointer.slice(home.length + 1).split("/");
    const name = steps[steps.length - 1];
    const where = steps.slice(0, -1).map((step) => step.replaceAll("_", " "));
    const usual = about?.default;
    const unit = unitOf(name.replace("_per_rad", "")) + (name.endsWith("_per_rad") ? "/rad" : "") || (about?.["x-unit"] && about["x-unit"] !== "1" ? shownUnit(about["x-unit"]) : "");
    groups.get(home)?.rows.push({
      label: sentence([...where, wordsOf(name)].join(", ")), value: shown(value), unit, help: about?.description ?? "",
      differs: usual !== undefined && usual !== null && JSON.stringify(usual) !== JSON.stringify(value), usual: usual === undefined || usual === null ? null : shown(usual),
    });
  });
  return [...groups.values()].filter(({ rows }) => rows.length);
}

/** A field's name as words; proper names keep their capitals. @param {string} name */
const wordsOf = (name) => labelOf(name.replace("_per_rad", "")).toLowerCase().replace("youngs", "Young's").replace("poissons", "Poisson's");

/**
 * Calls `found` with pointer, value and schema of every value that is not an object.
 * @param {unknown} value
 * @param {any} schema
 * @param {string} pointer
 * @param {(pointer: string, value: unknown, schema: any) => void} found
 */
function walk(value, schema, pointer, found) {
  if (value === null || value === undefined) return;
  if (typeof value === "object" && !Array.isArray(value)) {
    for (const [name, inner] of Object.entries(value)) walk(inner, schema?.properties?.[name], `${pointer}/${name}`, found);
  } else {
    found(pointer, value, schema);
  }
}

/** @param {any} value @returns {string} */
function shown(value) {
  if (Array.isArray(value)) {
    if (value.length > 8) return `${value.length} values`;
    return value.map((one) => (typeof one === "object" && one !== null ? members(one) : shown(one))).join("; ");
  }
  if (typeof value === "boolean") return value ? "yes" : "no";
  return typeof value === "number" ? number(value, 8) : String(value).replaceAll("_", " ");
}

/** What an entry of a list has, with names and units; null members are derived and left out. @param {object} entry */
function members(entry) {
  const given = Object.entries(entry).filter(([, value]) => value !== null);
  return given.map(([name, value]) => `${wordsOf(name)} ${shown(value)} ${unitOf(name)}`.trim()).join(", ");
}
