// The plane of action of both halves: zone of contact and lines of contact, which move across it.

import { number } from "../common/format.js";
import { group, put, svg, text } from "./svg.js";

const WIDTH = 352;
const HEIGHT = 132;
const MARGIN = { left: 22, right: 8, top: 22, bottom: 26 };
/** Least height of the zone, px: below it the roll direction is drawn larger than the axial one. */
const LEAST_PX = 40;

/**
 * Draws the plane; the function returned moves the lines to a phase of the mesh period.
 * @param {SVGSVGElement} root
 * @param {PairDrawing} drawing
 */
export function drawPlane(root, { plane_of_action: plane, section }) {
  const [start, end] = plane.path_roll_mm;
  const [low, high] = [plane.left.axial_mm[0], plane.right.axial_mm[1]];
  const roomX = WIDTH - MARGIN.left - MARGIN.right;
  const roomY = HEIGHT - MARGIN.top - MARGIN.bottom;
  const scale = Math.min(roomX / (high - low), roomY / (end - start));
  const stretch = Math.max(1, Math.min(Math.ceil(LEAST_PX / ((end - start) * scale)), Math.floor(roomY / ((end - start) * scale))));
  const offset = MARGIN.left + 0.5 * (roomX - (high - low) * scale);
  const bottom = MARGIN.top + 0.5 * (roomY + (end - start) * scale * stretch);
  /** @param {number} axial */
  const x = (axial) => offset + (axial - low) * scale;
  /** @param {number} roll */
  const y = (roll) => bottom - (roll - start) * scale * stretch;

  root.setAttribute("viewBox", `0 0 ${WIDTH} ${HEIGHT}`);
  const parts = [];
  const moving = [];
  for (const [name, half] of /** @type {[string, PairDrawing["plane_of_action"]["left"]][]} */ ([["left", plane.left], ["right", plane.right]])) {
    const [from, to] = half.axial_mm.map(x);
    const zone = { x: from, y: y(end), width: to - from, height: y(start) - y(end) };
    const cut = svg("clipPath", { id: `zone-${name}` });
    put(cut, svg("rect", zone));
    const lines = group("lines");
    for (const { axial_mm: axial, roll_mm: roll } of half.lines) {
      put(lines, svg("line", { class: "contact-line", x1: x(axial[0]), y1: y(roll[0]), x2: x(axial[1]), y2: y(roll[1]) }));
    }
    const window = group("window", { "clip-path": `url(#zone-${name})` });
    put(window, lines);
    moving.push(lines);
    parts.push(cut, svg("rect", { class: "zone", ...zone }), window);
    parts.push(text("member", 0.5 * (from + to), y(end) - 7, `${name} half (${half.pinion_hand} hand)`, "middle"));
  }
  const at = x(plane.section_axial_mm);
  parts.push(svg("path", { class: "section-mark", d: `M${at} ${y(end)}V${y(start)}` }));
  parts.push(text("note", at, y(start) + 12, "section above", "middle"));
  const arrow = 10;
  parts.push(svg("path", { class: "motion", d: `M${arrow} ${y(start)}V${y(end)}m-3.5 6l3.5 -6l3.5 6` }));
  parts.push(text("name", arrow, y(start) + 12, "A"), text("name", arrow, y(end) - 6, "E"));
  const width = number(plane.left.axial_mm[1] - plane.left.axial_mm[0], 4);
  const note = stretch > 1 ? `2 × ${width} mm; path drawn ${stretch} × larger` : `2 × ${width} mm wide, to scale`;
  parts.push(text("note", WIDTH - 6, HEIGHT - 4, note, "end"));
  root.replaceChildren(title(root), describe(root, plane, section), ...parts);

  const period = section.base_pitch_mm * scale * stretch;
  return (/** @type {number} */ phase) => moving.forEach((lines) => lines.setAttribute("transform", `translate(0 ${-phase * period})`));
}

/** @param {SVGElement} root */
function title(root) {
  const node = svg("title", { id: `${root.id}-title` });
  node.textContent = "Plane of action of both halves with the lines of contact";
  return node;
}

/** @param {SVGElement} root @param {PairDrawing["plane_of_action"]} plane @param {SectionDrawing} section */
function describe(root, plane, section) {
  const node = svg("desc", { id: `${root.id}-desc` });
  const [least, greatest] = plane.left.contact_length_mm.map((length) => number(length, 4));
  node.textContent =
    `The hands named are the pinion's. Lines of contact stand at ${number(plane.base_helix_angle_deg, 4)}° to the axis and move from A to E, one transverse base pitch of ` +
    `${number(section.base_pitch_mm, 4)} mm per mesh period. Their total length on one half is between ${least} and ${greatest} mm.`;
  return node;
}
