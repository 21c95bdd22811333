// Both shafts to scale, in the plane of their axes. All places come from the server; here they are scaled.

import { byId, show } from "../common/dom.js";
import { number } from "../common/format.js";
import { group, put, svg, text } from "./svg.js";

/** @typedef {NonNullable<PairDrawing["shafts"]>} ShaftsDrawing */
/** @typedef {ShaftsDrawing["pinion"]} ShaftDrawing */

const WIDTH = 720;
const MOST_HEIGHT = 420;
const MARGIN = { x: 46, top: 22, bottom: 42 };

/** The drawing in the section of the form: `show` draws or hides it, `fade` marks it as no longer that of the form. */
export function initShaftsDrawing() {
  const box = byId("shafts-drawing");
  const root = byId("drawing-shafts");
  return {
    /** @param {PairDrawing} drawing */
    show({ shafts }) {
      show(box, Boolean(shafts));
      box.classList.remove("stale");
      if (shafts) drawShafts(root, shafts);
    },
    fade() {
      box.classList.add("stale");
    },
    clear() {
      show(box, false);
    },
  };
}

/**
 * Places of the drawing: along the axes and across them, and px per mm.
 * @typedef {{ x: (axial: number) => number, y: (across: number) => number, scale: number }} Place
 */

/**
 * Draws both shafts; `said` is told after them. Returns the places, for what is drawn on top.
 * @param {SVGSVGElement} root
 * @param {ShaftsDrawing} shafts
 * @param {string} [said]
 * @returns {Place}
 */
export function drawShafts(root, shafts, said = "") {
  const both = [shafts.pinion, shafts.gear];
  const ends = both.flatMap((shaft) => [...shaft.segments.flatMap((one) => one.axial_mm), shaft.coupling_mm]);
  const [left, right] = [Math.min(...ends), Math.max(...ends)];
  const reach = (/** @type {ShaftDrawing} */ shaft) => Math.max(shaft.tip_radius_mm, ...shaft.segments.map((one) => one.radius_mm));
  const [low, high] = [-reach(shafts.pinion), shafts.center_distance_mm + reach(shafts.gear)];
  const scale = Math.min((WIDTH - 2 * MARGIN.x) / (right - left), (MOST_HEIGHT - MARGIN.top - MARGIN.bottom) / (high - low));
  const height = Math.round((high - low) * scale + MARGIN.top + MARGIN.bottom);
  const offset = 0.5 * (WIDTH - (right - left) * scale);
  /** @param {number} axial */
  const x = (axial) => offset + (axial - left) * scale;
  /** @param {number} across */
  const y = (across) => height - MARGIN.bottom - (across - low) * scale;
  const place = { x, y, scale };

  root.setAttribute("viewBox", `0 0 ${WIDTH} ${height}`);
  const middle = svg("path", { class: "axis", d: `M${x(0)} ${MARGIN.top - 10}V${height - MARGIN.bottom + 6}` });
  const parts = [
    drawShaft(shafts.gear, "gear", "out", place),
    drawShaft(shafts.pinion, "pinion", "in", place),
    middle,
    ...scaleBar(scale, height),
    text("note", WIDTH - 6, height - 6, "to scale; x upwards, z to the right", "end"),
  ];
  const title = svg("title", { id: `${root.id}-title` });
  title.textContent = "Shafts and bearings of pinion and gear, to scale";
  const desc = svg("desc", { id: `${root.id}-desc` });
  desc.textContent = [...both.map((shaft, index) => described(index ? "gear" : "pinion", shaft)), said].filter(Boolean).join(" ");
  root.replaceChildren(title, desc, group("world"), ...parts);
  return place;
}

/**
 * @param {ShaftDrawing} shaft
 * @param {"pinion" | "gear"} name
 * @param {"in" | "out"} torque
 * @param {Place} place
 */
function drawShaft(shaft, name, torque, { x, y, scale }) {
  const node = group(`shaft ${name}`);
  const axis = y(shaft.axis_mm);
  /** @param {number[]} axial @param {number} radius */
  const bar = ([from, to], radius) => ({ x: x(from), y: axis - radius * scale, width: (to - from) * scale, height: 2 * radius * scale });
  for (const { axial_mm: axial, radius_mm: radius } of shaft.segments) put(node, svg("rect", { class: "segment", ...bar(axial, radius) }));
  for (const { axial_mm: axial, bore_radius_mm: bore } of shaft.segments) if (bore > 0) put(node, svg("rect", { class: "shaft-bore", ...bar(axial, bore) }));
  for (const [from, to] of shaft.faces_mm) {
    const [tip, rim] = [shaft.tip_radius_mm, shaft.root_radius_mm].map((radius) => radius * scale);
    const depth = Math.max(tip - rim, 1);
    for (const top of [axis - tip, axis + tip - depth]) put(node, svg("rect", { class: "teeth", x: x(from), y: top, width: (to - from) * scale, height: depth }));
    put(node, svg("rect", { class: "face", x: x(from), y: axis - tip, width: (to - from) * scale, height: 2 * tip }));
  }
  const lengths = shaft.segments.flatMap((one) => one.axial_mm);
  put(node, svg("path", { class: "axis", d: `M${x(Math.min(...lengths)) - 8} ${axis}H${x(Math.max(...lengths)) + 8}` }));
  shaft.bearings.forEach((bearing, index) => put(node, drawBearing(bearing, index, axis, x, scale)));
  for (const at of shaft.bodies_mm) put(node, svg("path", { class: "body-mark", d: `M${x(at)} ${axis - 16}V${axis + 16}` }));
  put(node, ...drawCoupling(shaft, torque, axis, x));
  const floats = shaft.floats_axially ? ", floats" : "";
  put(node, text("member", x(0), axis + 4, `${name}${floats}`, "middle"));
  return node;
}

/**
 * A box with a cross on either side of the shaft; bars where it holds the shaft axially.
 * @param {ShaftDrawing["bearings"][number]} bearing
 * @param {number} index
 * @param {number} axis
 * @param {(axial: number) => number} x
 * @param {number} scale
 */
function drawBearing(bearing, index, axis, x, scale) {
  const node = group(`bearing${bearing.holds_axially ? " axial" : ""}${bearing.holds_radially ? "" : " thrust"}`);
  const size = Math.max(9, Math.min(18, 0.5 * bearing.radius_mm * scale));
  const at = x(bearing.axial_mm);
  for (const side of [-1, 1]) {
    const near = axis + side * bearing.radius_mm * scale;
    const [top, bottom] = side < 0 ? [near - size, near] : [near, near + size];
    const [from, to] = [at - 0.5 * size, at + 0.5 * size];
    put(node, svg("rect", { class: "ring", x: from, y: top, width: size, height: size }));
    put(node, svg("path", { class: "cross", d: `M${from} ${top}L${to} ${bottom}M${to} ${top}L${from} ${bottom}` }));
    if (bearing.holds_axially) put(node, svg("path", { class: "stop", d: `M${from - 3} ${top}V${bottom}M${to + 3} ${top}V${bottom}` }));
  }
  put(node, text("note", at, axis + bearing.radius_mm * scale + size + 11, `${index + 1}`, "middle"));
  return node;
}

/**
 * @param {ShaftDrawing} shaft
 * @param {"in" | "out"} torque
 * @param {number} axis
 * @param {(axial: number) => number} x
 */
function drawCoupling(shaft, torque, axis, x) {
  const at = x(shaft.coupling_mm);
  /** @type {SVGElement[]} */
  const nodes = [svg("rect", { class: "coupling", x: at - 3, y: axis - 13, width: 6, height: 26 })];
  const middle = shaft.segments.flatMap((one) => one.axial_mm);
  const side = shaft.coupling_mm < 0.5 * (Math.min(...middle) + Math.max(...middle)) ? -1 : 1;
  const [tail, head] = (torque === "in") ? [at + side * 26, at + side * 6] : [at + side * 6, at + side * 26];
  const back = Math.sign(tail - head);
  nodes.push(svg("path", { class: "torque", d: `M${tail} ${axis}H${head}m${back * 5} -4L${head} ${axis}l${back * 5} 4` }));
  nodes.push(text("note", at + side * 8, axis - 9, `T ${torque}`, side < 0 ? "end" : "start"));
  if (shaft.has_machine) nodes.push(svg("circle", { class: "machine", cx: at + side * 36, cy: axis, r: 8 }));
  if (shaft.coupling_holds_axially) nodes.push(svg("path", { class: "stop", d: `M${at - 6} ${axis - 13}v26M${at + 6} ${axis - 13}v26` }));
  return nodes;
}

/** A bar of a round length in mm. @param {number} scale px per mm @param {number} height */
function scaleBar(scale, height) {
  const most = 140 / scale;
  const decade = 10 ** Math.floor(Math.log10(most));
  const length = [5, 2, 1].map((step) => step * decade).find((step) => step <= most) ?? decade;
  const [x, y, end] = [8, height - 9, 8 + length * scale];
  return [
    svg("path", { class: "scale-bar", d: `M${x} ${y - 4}V${y}H${end}V${y - 4}` }),
    text("note", end + 6, y + 1, `${number(length)} mm`),
  ];
}

/** @param {string} name @param {ShaftDrawing} shaft */
function described(name, shaft) {
  const ends = shaft.segments.flatMap((one) => one.axial_mm);
  const length = number(Math.max(...ends) - Math.min(...ends), 4);
  const bearings = shaft.bearings.map(({ axial_mm: at, holds_axially: axial }) => `${number(at, 4)} mm${axial ? " (axial too)" : ""}`).join(", ");
  return (
    `The ${name}'s shaft is ${length} mm long in ${shaft.segments.length} segments, with bearings at ${bearings} and the coupling at ` +
    `${number(shaft.coupling_mm, 4)} mm from the middle of the gap${shaft.floats_axially ? "; it floats axially" : ""}.`
  );
}
