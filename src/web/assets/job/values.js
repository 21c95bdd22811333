// Every number and word of the result.

import { byId, fillRows, show, theoryLink } from "../common/dom.js";
import { SCALARS, rowOf } from "../common/scalars.js";

/** @param {JobContext} context */
export function showValues({ result }) {
  const rows = SCALARS.flatMap((scalar) => {
    const [label, value, unit] = rowOf(result, scalar, 6);
    return value === null ? [] : [[theoryLink(scalar, label), value, unit, scalar.help]];
  });
  fillRows(byId("values-table").tBodies[0], rows);
  show(byId("values"), rows.length > 0);
}
