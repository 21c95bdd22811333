// The pair to scale: the teeth in the transverse section with the path of contact. All geometry comes from the
// server; here it is turned, shifted and scaled.

import { byId } from "../common/dom.js";
import { number } from "../common/format.js";
import { drawPlane } from "./plane.js";
import { group, put, svg, text } from "./svg.js";

const WIDTH = 352;
const HEIGHT = 236;

/** The drawing in the panel: `show` draws, `fade` marks it as no longer that of the form. */
export function initDrawing() {
  const section = byId("drawing-section");
  const plane = byId("drawing-plane");
  const slider = byId("drawing-phase");
  const play = byId("drawing-play");
  const calm = window.matchMedia("(prefers-reduced-motion: reduce)");
  /** @type {((phase: number) => void)[]} */
  let movers = [];
  /** @type {number | null} */
  let frame = null;

  const place = () => {
    const phase = Number(slider.value);
    byId("drawing-phase-value").textContent = phase.toFixed(2);
    for (const move of movers) move(phase);
  };

  function stop() {
    if (frame !== null) cancelAnimationFrame(frame);
    frame = null;
    play.textContent = "Turn";
    play.setAttribute("aria-pressed", "false");
  }

  function turn() {
    if (frame !== null) return stop();
    const from = performance.now() - Number(slider.value) * PERIOD_MS;
    /** @param {number} now */
    const step = (now) => {
      slider.value = (((now - from) / PERIOD_MS) % 1).toFixed(3);
      place();
      frame = requestAnimationFrame(step);
    };
    frame = requestAnimationFrame(step);
    play.textContent = "Stop";
    play.setAttribute("aria-pressed", "true");
  }

  const dressForMotion = () => {
    play.hidden = calm.matches;
    if (calm.matches && frame !== null) stop();
  };
  calm.addEventListener("change", dressForMotion);
  dressForMotion();
  slider.addEventListener("input", () => {
    if (frame !== null) stop();
    place();
  });
  play.addEventListener("click", turn);

  return {
    /** @param {PairDrawing} drawing */
    show(drawing) {
      movers = [drawSection(section, drawing.section), drawPlane(plane, drawing)];
      byId("drawing").classList.remove("stale");
      place();
    },
    fade() {
      byId("drawing").classList.add("stale");
    },
    /** No pair is drawn. */
    clear() {
      movers = [];
      for (const root of [section, plane]) {
        const texts = [...root.children].filter((node) => node.matches("title, desc"));
        texts.forEach((node, index) => { node.textContent = index ? "" : "No pair yet"; });
        root.replaceChildren(...texts);
      }
    },
  };
}

const PERIOD_MS = 4000;

/**
 * Draws the section; the function returned moves it to a phase of the mesh period.
 * @param {SVGSVGElement} root
 * @param {SectionDrawing} section
 */
export function drawSection(root, section) {
  const { pinion, gear, points } = section;
  /** @type {Points} */
  const at = Object.fromEntries(points.map((point) => [point.name, point]));
  const pitch = Math.abs(pinion.turn_rad) * pinion.working_pitch_radius_mm;
  const left = Math.max(-2.4 * pitch, Math.min(at.T1.at_mm[0] - 0.25 * pitch, -1.25 * pitch));
  const right = Math.min(2.4 * pitch, Math.max(at.T2.at_mm[0] + 0.25 * pitch, 1.25 * pitch));
  const scale = WIDTH / (right - left);
  const shown = { left, right, top: (0.5 * HEIGHT) / scale, scale };
  /** @param {number[]} point */
  const toScreen = ([x, y]) => [(x - left) * scale, 0.5 * HEIGHT - y * scale];

  root.setAttribute("viewBox", `0 0 ${WIDTH} ${HEIGHT}`);
  const world = group("world", { transform: `translate(${-left * scale} ${0.5 * HEIGHT}) scale(${scale} ${-scale})` });
  const bodies = [drawGear(pinion, "pinion", 0.5 * Math.PI, shown), drawGear(gear, "gear", -0.5 * Math.PI, shown)];
  put(world, ...bodies.map((body) => body.node));
  for (const [body, name] of /** @type {[SectionDrawing["pinion"], string][]} */ ([[pinion, "pinion"], [gear, "gear"]])) {
    for (const kind of /** @type {const} */ (["root", "tip", "base", "reference", "working_pitch"])) {
      put(world, svg("circle", { class: `circle ${kind} ${name}`, cx: body.center_mm[0], cy: body.center_mm[1], r: body[`${kind}_radius_mm`] }));
    }
  }
  put(
    world,
    line("line-of-action", at.T1.at_mm, at.T2.at_mm),
    line("path-of-contact", at.A.at_mm, at.E.at_mm),
  );

  const labels = group("labels");
  const across = [-Math.sin(angle(at)), Math.cos(angle(at))];
  points.forEach((point, index) => {
    const [x, y] = toScreen(point.at_mm);
    if (x < 4 || x > WIDTH - 4 || y < 4 || y > HEIGHT - 4) return;
    const side = index % 2 ? -1 : 1;
    const [dx, dy] = [side * across[0] * 15, -side * across[1] * 15];
    const active = !point.name.startsWith("T");
    put(labels, svg("circle", { class: active ? "point" : "point tangent", cx: x, cy: y, r: active ? 2.2 : 2 }));
    put(labels, text("name", x + dx, y + dy + 4, subscripted(point.name)));
  });
  put(labels, ...scaleBar(scale));
  const contacts = group("contacts");
  const dots = section.contacts_roll_mm.map(() => svg("circle", { class: "contact", r: 4 }));
  put(contacts, ...dots);
  const seen = text("note", WIDTH - 6, HEIGHT - 8, `seen from the ${section.seen_from} end`, "end");
  const names = [text("member", 8, 16, `Gear, z ${gear.teeth} ↺`), text("member", 8, HEIGHT - 24, `Pinion, z ${pinion.teeth}, drives ↻`)];
  root.replaceChildren(title(root, section), describe(root, section, at), world, labels, contacts, seen, ...names);

  const [from, to] = [at.A, at.E];
  return (phase) => {
    bodies.forEach((body) => body.turn(phase));
    section.contacts_roll_mm.forEach((roll, index) => {
      const part = (roll + phase * section.base_pitch_mm - from.roll_mm) / (to.roll_mm - from.roll_mm);
      const on = part >= -1e-9 && part <= 1 + 1e-9;
      dots[index].classList.toggle("away", !on);
      if (!on) return;
      const [x, y] = toScreen([0, 1].map((axis) => from.at_mm[axis] + part * (to.at_mm[axis] - from.at_mm[axis])));
      dots[index].setAttribute("cx", String(x));
      dots[index].setAttribute("cy", String(y));
    });
  };
}

/** @typedef {Record<string, SectionDrawing["points"][number]>} Points points of the line of action by name */

/** @param {Points} at */
const angle = (at) => Math.atan2(at.T2.at_mm[1] - at.T1.at_mm[1], at.T2.at_mm[0] - at.T1.at_mm[0]);
/** @param {string} name */
const subscripted = (name) => name.replace("1", "₁").replace("2", "₂");
/** @param {string} name @param {number[]} from @param {number[]} to */
const line = (name, [x1, y1], [x2, y2]) => svg("line", { class: name, x1, y1, x2, y2 });

/**
 * A gear: its visible teeth, turned about its axis.
 * @param {SectionDrawing["pinion"]} gear
 * @param {string} name
 * @param {number} towardsMate angle of the line of centres
 * @param {{ left: number, right: number }} shown
 */
function drawGear(gear, name, towardsMate, shown) {
  const pitch = Math.abs(gear.turn_rad);
  // Half the angle under which the picture is seen from the axis, and a tooth more that comes in while turning.
  const reach = Math.asin(Math.min(1, (1.1 * Math.max(-shown.left, shown.right)) / gear.root_radius_mm));
  const each = Math.ceil(reach / pitch) + 2;
  const whole = 2 * each + 1 >= gear.teeth;
  const count = whole ? gear.teeth : 2 * each + 1;
  const outline = [];
  for (let tooth = 0; tooth < count; tooth += 1) {
    const turned = pitch * (tooth - (count - 1) / 2);
    const [sin, cos] = [Math.sin(turned), Math.cos(turned)];
    for (const [x, y] of gear.tooth_mm) outline.push(`${(x * cos - y * sin).toFixed(5)} ${(x * sin + y * cos).toFixed(5)}`);
  }
  // The tooth that stands nearest to the mate, and with an even number of teeth half a pitch beside it.
  const off = Math.round((gear.angle_rad - towardsMate) / pitch) * pitch - (count % 2 ? 0 : 0.5 * pitch);
  const path = `M${outline.join("L")}`;
  const node = group(`gear ${name}`, { transform: `translate(${gear.center_mm.join(" ")})` });
  const turning = group("turning");
  put(turning, svg("path", { class: "body", d: whole ? `${path}Z` : `${path}L0 0Z` }), svg("path", { class: "flanks", d: whole ? `${path}Z` : path }));
  put(node, turning);
  if (gear.bore_radius_mm > 0) put(node, svg("circle", { class: "bore", r: gear.bore_radius_mm }));
  /** @param {number} phase */
  const turn = (phase) => turning.setAttribute("transform", `rotate(${((gear.angle_rad - off + gear.turn_rad * phase) * 180) / Math.PI})`);
  return { node, turn };
}

/** A bar of a round length in mm. @param {number} scale px per mm */
function scaleBar(scale) {
  const most = 80 / scale;
  const decade = 10 ** Math.floor(Math.log10(most));
  const length = [5, 2, 1].map((step) => step * decade).find((step) => step <= most) ?? decade;
  const [x, y, end] = [8, HEIGHT - 9, 8 + length * scale];
  return [
    svg("path", { class: "scale-bar", d: `M${x} ${y - 4}V${y}H${end}V${y - 4}` }),
    text("note", end + 6, y + 1, `${number(length)} mm`),
  ];
}

/** @param {SVGElement} root @param {SectionDrawing} section */
function title(root, section) {
  const node = svg("title", { id: `${root.id}-title` });
  node.textContent = `Tooth pair in the transverse section: ${section.pinion.teeth} and ${section.gear.teeth} teeth, to scale`;
  return node;
}

/** @param {SVGElement} root @param {SectionDrawing} section @param {Points} at */
function describe(root, section, at) {
  const node = svg("desc", { id: `${root.id}-desc` });
  const path = number(at.E.roll_mm - at.A.roll_mm, 4);
  const [a, e] = [at.A, at.E].map((point) => number(point.roll_mm, 4));
  node.textContent =
    `The pinion below drives the gear above. Contact runs along the line of action from A, ${a} mm from the base tangent point T1, ` +
    `to E at ${e} mm: a path of ${path} mm. Transverse base pitch ${number(section.base_pitch_mm, 4)} mm.`;
  return node;
}
