// The geometry of the pair and of its members.

import { byId, el, fillRows, fillValues, show } from "../common/dom.js";
import { number } from "../common/format.js";
import { gearData, symbolOf } from "../report/iso21771.js";

export function showGeometry({ result: { geometry, response }, input }) {
  if (!geometry) return;
  const { pair, members } = gearData({ geometry, input, response });
  fillValues(byId("geometry-values"), pair.filter(({ value }) => value !== null).map(({ symbol, name, value, unit }) => [named(symbol, name), number(value, 6), unit]));
  const rows = members.filter(({ pinion, gear }) => pinion !== null && gear !== null);
  fillRows(byId("gears").tBodies[0], rows.map(({ symbol, name, pinion, gear, unit }) => [named(symbol, name), number(pinion, 6), number(gear, 6), unit]));
  show(byId("geometry"));
}

const named = (symbol, name) => el("span", {}, name, symbol[0] ? " " : "", symbolOf(symbol) ?? "");
