// Sentences of the API as people read them: units with their symbols, names of fields as words, no pointers.

import { pointerLabel, unitOf } from "./format.js";

/** Units as the API's sentences write them, and their symbols. @type {[RegExp, string][]} */
const UNITS = [
  [/\bkg m(?:\^?2|²)/g, "kg·m²"],
  [/\bkg\/m\^?3/g, "kg/m³"],
  [/\bm\/s\^?2\b/g, "m/s²"],
  [/\bN m\b/g, "N·m"],
  [/\(mm um\)/g, "(mm·µm)"],
  [/\bum\b/g, "µm"],
  [/(\d) us\b/g, "$1 µs"],
  [/(\d) deg\b/g, "$1°"],
  [/\bdeg\b(?!\.)/g, "°"],
  [/\bm_n\b/g, "mₙ"],
];

/** Names of fields and words of the document in a sentence, with the value behind them where there is one. */
export const FIELD_NAME = /`?\b([a-z][a-z0-9]*(?:_[a-z0-9]+)+)\b`?( \d[\d.]*(?:e-?\d+)?(?![\w.]*\d| [µ°A-Za-z]))?/g;

/** The value behind a name of a field, with the unit in the name. @param {string} name @param {string} [value] */
export const withValue = (name, value) => (value ? [value, unitOf(name)].filter(Boolean).join(" ") : "");

/** Pointers in a sentence. */
const POINTER = /(?<![\w/])"?(\/(?:[a-z][a-z_]*|\d+)(?:\/[a-z0-9_]+)+)"?/g;

/** A pointer as words: "/design/pinion/teeth" is "Pinion teeth". @param {string} pointer */
export const placeOf = (pointer) => (pointer ? pointerLabel(pointer).label : "");

/** A sentence with units as symbols and pointers as words; names of fields are left. @param {unknown} text */
export const withUnits = (text) =>
  UNITS.reduce((sentence, [unit, symbol]) => sentence.replace(unit, symbol), String(text ?? "").replace(POINTER, (_, pointer) => `“${placeOf(pointer)}”`));

/** A sentence of the API for people. @param {unknown} text */
export const readable = (text) => withUnits(text).replace(FIELD_NAME, (_, name, value) => pointerLabel(name).label.toLowerCase() + withValue(name, value));

/** The code of a warning or violation as words. @param {string} code */
export const codeWords = (code) => code.replaceAll("-", " ");
