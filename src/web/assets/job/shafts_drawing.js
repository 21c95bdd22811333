// Both shafts to scale with their deflected centre lines and bearing forces, or with one of their modes. Displacements
// come from the server; here they are magnified.

import { number } from "../common/format.js";
import { drawShafts } from "../design/shafts.js";
import { group, put, svg } from "../design/svg.js";
import { MEMBERS, deflectionOf, leftEnd } from "./shafts_plots.js";

/** @typedef {import("./shafts_plots.js").ShaftsDrawing} ShaftsDrawing */

/** Largest displacement and longest force in the drawing, px. */
const LARGEST_PX = 30;
const LONGEST_PX = 44;
/** Every so many stations a point shows the motion along the axis. */
const POINT_EVERY = 5;
/** Displacements below this share of the largest are not drawn. */
const NOTICEABLE = 0.02;

/** The largest of 1, 2, 5, 10, … that is not above a number. @param {number} most */
function roundDown(most) {
  const decade = 10 ** Math.floor(Math.log10(most));
  return ([5, 2, 1].find((step) => step * decade <= most * (1 + 1e-9)) ?? 1) * decade;
}

/** @param {number[][]} lists */
const largestOf = (...lists) => lists.flat().reduce((most, value) => Math.max(most, Math.abs(value)), 0);

/** @param {number[]} x @param {number[]} y px */
const pathOf = (x, y) => x.map((at, index) => `${index ? "L" : "M"}${at.toFixed(2)} ${y[index].toFixed(2)}`).join("");

/**
 * The static deflection under the load; returns how often it is magnified.
 * @param {SVGSVGElement} root
 * @param {ShaftsDrawing} drawing
 * @param {ShaftsResult} shafts
 */
export function drawDeflection(root, drawing, shafts) {
  const largest = largestOf(...MEMBERS.map((member) => deflectionOf(shafts[member])).flatMap(({ x_um: x, y_um: y }) => [x, y]));
  const place = drawShafts(root, drawing);
  const factor = largest > 0 ? roundDown(LARGEST_PX / (largest * 1e-3 * place.scale)) : 1;
  const longest = largestOf(...MEMBERS.flatMap((member) => shafts[member].bearings.map(({ force_on_shaft_n: force }) => force.slice(0, 2))));
  for (const member of MEMBERS) {
    const { bearings } = shafts[member];
    const deflection = deflectionOf(shafts[member]);
    const shaft = drawing[member];
    const axis = place.y(shaft.axis_mm);
    const x = deflection.station_mm.map((station) => place.x(station + leftEnd(shaft)));
    const node = group(`deflection ${member}`);
    for (const [name, values] of /** @type {const} */ ([["x", deflection.x_um], ["y", deflection.y_um]])) {
      put(node, svg("path", { class: `deflected ${name}`, d: pathOf(x, values.map((value) => axis - value * 1e-3 * place.scale * factor)) }));
    }
    bearings.forEach(({ force_on_shaft_n: force }, index) => {
      const at = place.x(shaft.bearings[index].axial_mm);
      ["x", "y"].forEach((name, direction) => {
        const length = longest > 0 ? (force[direction] / longest) * LONGEST_PX : 0;
        if (Math.abs(length) > 2) put(node, ...arrow(name, at + (direction ? 6 : -6), axis, length));
      });
    });
    root.append(node);
  }
  const desc = root.querySelector("desc");
  if (desc) desc.textContent += ` Drawn on them: the deflected centre lines in both planes, magnified ${number(factor)} times, and the forces of the bearings.`;
  return factor;
}

/**
 * An arrow upwards, or downwards where the length is negative; all in px.
 * @param {string} name
 * @param {number} x
 * @param {number} from
 * @param {number} length
 */
function arrow(name, x, from, length) {
  const [to, back] = [from - length, Math.sign(length) * 6];
  return [svg("path", { class: `force ${name}`, d: `M${x} ${from}V${to + 0.5 * back}` }), svg("path", { class: "force head", d: `M${x - 3.5} ${to + back}L${x} ${to}l3.5 ${back}` })];
}

/**
 * A mode along both shafts; the function returned moves it to a phase (0: full deflection, 0.5: the opposite one).
 * @param {SVGSVGElement} root
 * @param {ShaftsDrawing} drawing
 * @param {RotorMode} mode
 * @param {string} name
 */
export function drawMode(root, drawing, mode, name) {
  const place = drawShafts(root, drawing, `Drawn on them: ${name}.`);
  for (const shaft of root.querySelectorAll(".shaft")) shaft.classList.add("ghost");
  const shapes = MEMBERS.map((member) => ({ member, shaft: drawing[member], shape: mode.along[member] }));
  const largest = largestOf(...shapes.flatMap(({ shape }) => [shape.x, shape.y, shape.z, shape.twist]));
  const px = largest > 0 ? LARGEST_PX / largest : 0;
  const isNoticeable = (/** @type {number[]} */ values) => largestOf(values) > NOTICEABLE * largest;
  const movers = shapes.flatMap(({ member, shaft, shape }) => {
    const axis = place.y(shaft.axis_mm);
    const x = shape.station_mm.map((station) => place.x(station + leftEnd(shaft)));
    const node = group(`mode ${member}`);
    /** @type {((share: number) => void)[]} */
    const lines = [];
    /** @param {string} component @param {number[]} across @param {boolean} isMovedAlong */
    const add = (component, across, isMovedAlong) => {
      const path = svg("path", { class: `deflected ${component}` });
      put(node, path);
      lines.push((share) => path.setAttribute("d", pathOf(x.map((at, index) => at + (isMovedAlong ? share * px * shape.z[index] : 0)), across.map((value) => axis - share * px * value))));
    };
    add("x", shape.x, true);
    if (isNoticeable(shape.y)) add("y", shape.y, true);
    if (isNoticeable(shape.twist)) add("twist", shape.twist, false);
    x.forEach((at, index) => {
      if (index % POINT_EVERY) return;
      const point = svg("circle", { class: "station", r: 2.6 });
      put(node, point);
      lines.push((share) => {
        point.setAttribute("cx", String(at + share * px * shape.z[index]));
        point.setAttribute("cy", String(axis - share * px * shape.x[index]));
      });
    });
    root.append(node);
    return lines;
  });
  /** @param {number} phase */
  const move = (phase) => movers.forEach((mover) => mover(Math.cos(2 * Math.PI * phase)));
  move(0);
  return move;
}
