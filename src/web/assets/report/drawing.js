// The drawing of the pair in a report: section and plane of action, to scale.

import * as api from "../common/api.js";
import { byId, show } from "../common/dom.js";
import { drawSection } from "../design/drawing.js";
import { drawPlane } from "../design/plane.js";

/** Phase of the mesh period that is shown. */
const PHASE = 0.35;

/** Draws the pair; returns the data of the drawing, null where there is none. @param {JobInput} input */
export async function drawPair(input) {
  let drawing;
  try {
    ({ drawing } = await api.validate(input, { drawing: true }));
  } catch (error) {
    // The pair of an old document may be refused by this version: the report has no drawing then.
    if (error instanceof api.Problem && error.status === 422) return null;
    throw error;
  }
  if (!drawing) return null;
  for (const move of [drawSection(byId("drawing-section"), drawing.section), drawPlane(byId("drawing-plane"), drawing)]) move(PHASE);
  show(byId("pair-drawing"));
  return drawing;
}
