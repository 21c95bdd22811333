// Geometry, impact and numerics: tables and lists without plots.

import { byId, fillRows, fillValues, show } from "../common/dom.js";
import { labelOf, number, rowsOf, unitOf } from "../common/format.js";

export function showGeometry({ geometry }) {
  if (!geometry) return;
  fillValues(byId("geometry-values"), rowsOf(geometry, { digits: 6 }));
  const { pinion = {}, gear = {} } = geometry;
  const names = Object.keys({ ...pinion, ...gear });
  fillRows(byId("gears").tBodies[0], names.map((name) => [labelOf(name), number(pinion[name], 6), number(gear[name], 6), unitOf(name)]));
  show(byId("gears"), names.length > 0);
  show(byId("geometry"));
}

export function showImpact({ impact }) {
  if (!impact) return;
  const buffered = impact.source === "given" ? "Given" : "Corner contact, buffered by the pairs in mesh";
  const calculated = typeof impact.zhou2008_force_n === "number";
  fillRows(byId("impact-table").tBodies[0], [
    [buffered, `${number(impact.force_n)} N`],
    ...(calculated ? [["Zhou 2008, unbuffered", `${number(impact.zhou2008_force_n)} N`], ["Reduction", `${number(impact.reduction_percent, 4)} %`]] : []),
  ]);
  const { source, ...rest } = impact;
  fillValues(byId("impact-values"), [
    ["Excites the response", source?.replaceAll("_", " ")],
    ...rowsOf(rest, { skip: ["force_n", "zhou2008_force_n", "reduction_percent"] }),
  ]);
  show(byId("impact"));
}

export function showNumerics({ numerics }) {
  if (!numerics) return;
  const { wall_ms: wall = {}, reused = [], ...rest } = numerics;
  fillValues(byId("numerics-values"), [
    ...Object.entries(wall).map(([stage, ms]) => [`Time of ${stage}`, number(ms, 3), "ms"]),
    ["Reused", reused.length ? reused.join(", ") : "nothing"],
    ...rowsOf(rest, { digits: 9 }),
  ]);
  show(byId("numerics"));
}
