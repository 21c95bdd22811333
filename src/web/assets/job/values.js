// Every number and word of the result.

import { byId, el, fillRows, show } from "../common/dom.js";
import { SCALARS, rowOf } from "../common/scalars.js";

/** @param {JobContext} context */
export function showValues({ result }) {
  const rows = SCALARS.flatMap((scalar) => {
    const [label, value, unit] = rowOf(result, scalar, 6);
    return value === null ? [] : [[el("a", { href: `/help/theory/${scalar.theory}`, title: scalar.pointer }, label), value, unit, scalar.help]];
  });
  fillRows(byId("values-table").tBodies[0], rows);
  show(byId("values"), rows.length > 0);
}
