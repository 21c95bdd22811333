// The geometry of the pair and of its members.

import { byId, el, fillRows, fillValues, show, theoryLink } from "../common/dom.js";
import { number } from "../common/format.js";
import { memberRows, pairRows, symbolOf } from "../common/gear_data.js";

/** @param {JobContext} context */
export function showGeometry({ gearData }) {
  if (!gearData) return;
  fillValues(byId("geometry-values"), pairRows(gearData).map(({ symbol, name, value, unit, meaning }) => [named(symbol, name), number(value, 6), unit, meaning]));
  fillRows(byId("gears").tBodies[0], memberRows(gearData).map(({ symbol, name, pinion, gear, unit, meaning }) => [theoryLink(meaning, named(symbol, name)), number(pinion, 6), number(gear, 6), unit]));
  show(byId("geometry"));
}

/** @param {[string, string]} symbol @param {string} name */
const named = (symbol, name) => el("span", {}, name, symbol[0] ? " " : "", symbolOf(symbol) ?? "");
