// The part of a report that only jobs on shafts have: drawings, values, bearing forces and modes.

import { bodyOf, byId, el, fillRows, fillValues, show } from "../common/dom.js";
import { number } from "../common/format.js";
import { svg } from "../design/svg.js";
import { bearingRows } from "../job/bearings.js";
import { nameOfMode, rotorRows, rotorValues } from "../job/rotor.js";
import { frictionRows, reactionRows, shaftsValues } from "../job/shafts.js";
import { drawDeflection, drawMode } from "../job/shafts_drawing.js";

/** Modes that are drawn and listed. */
const DRAWN = 4;
const LISTED = 20;

/**
 * @param {JobResult} result
 * @param {import("../job/shafts_plots.js").ShaftsDrawing | null} drawing
 */
export function showShaftsBlock({ shafts, response }, drawing) {
  if (shafts) {
    show(byId("deflection"), Boolean(drawing));
    if (drawing) byId("deflection-factor").textContent = `magnified ${number(drawDeflection(byId("deflection-drawing"), drawing, shafts))} times`;
    fillValues(byId("shafts-values"), shaftsValues(shafts));
    fillRows(bodyOf(byId("reactions")), reactionRows(shafts));
    fillRows(bodyOf(byId("friction")), frictionRows(shafts));
    show(byId("friction"), Boolean(shafts.axial_friction));
    show(byId("shafts"));
  }
  if (response?.bearings?.length) {
    fillRows(bodyOf(byId("bearings-table")), bearingRows(response).map((row) => row.slice(0, 10)));
    show(byId("bearings"));
  }
  if (response?.rotor?.modes.length) showModesOf(response, response.rotor, drawing);
}

/**
 * The first modes, standing in full deflection.
 * @param {ResponseResult} response
 * @param {Rotor} rotor
 * @param {import("../job/shafts_plots.js").ShaftsDrawing | null} drawing
 */
function showModesOf(response, rotor, drawing) {
  if (drawing) {
    for (const [index, mode] of rotor.modes.slice(0, DRAWN).entries()) {
      const name = nameOfMode(mode, index);
      const id = `mode-drawing-${index}`;
      const root = svg("svg", { id, role: "img", "aria-labelledby": `${id}-title`, "aria-describedby": `${id}-desc` });
      byId("mode-drawings").append(el("figure", {}, el("figcaption", {}, name.replace(/^m/, "M")), root));
      drawMode(root, drawing, mode, name);
    }
  }
  fillRows(bodyOf(byId("rotor-table")), rotorRows(rotor).slice(0, LISTED));
  fillValues(byId("rotor-values"), rotorValues(response));
  byId("rotor-note").textContent = rotor.modes.length > LISTED ? `The first ${LISTED} of ${rotor.modes.length} modes in the result.` : "";
  show(byId("rotor"));
}
