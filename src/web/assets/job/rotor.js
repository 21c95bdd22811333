// Modes of both shafts: their table, and the one selected along the shafts, in motion.

import { byId, el, fillRows, fillValues, show } from "../common/dom.js";
import { number } from "../common/format.js";
import { rowsFrom } from "../common/scalars.js";
import { drawMode } from "./shafts_drawing.js";

const PERIOD_MS = 1800;

/** @param {JobContext} context @param {import("./shafts_plots.js").ShaftsDrawing | null} drawing */
export function showRotor({ result: { response } }, drawing) {
  const rotor = response?.rotor;
  if (!response || !rotor?.modes.length) return;
  show(byId("rotor"));
  fillRows(byId("rotor-table").tBodies[0], rotorRows(rotor));
  fillValues(byId("rotor-values"), rotorValues(response));
  show(byId("rotor-motion"), Boolean(drawing));
  if (drawing) animate(rotor, drawing);
}

/**
 * The drawing of the mode selected; it moves until it is paused, out of sight or printed.
 * @param {Rotor} rotor
 * @param {import("./shafts_plots.js").ShaftsDrawing} drawing
 */
function animate(rotor, drawing) {
  const root = byId("mode-drawing");
  const select = byId("mode-select");
  const button = byId("mode-pause");
  const calm = window.matchMedia("(prefers-reduced-motion: reduce)");
  select.replaceChildren(...rotor.modes.map((mode, index) => el("option", { value: String(index) }, nameOfMode(mode, index))));
  /** @type {(phase: number) => void} */
  let move = () => {};
  let isWanted = !calm.matches;
  let isSeen = false;
  let phase = 0;
  /** @type {number | null} */
  let frame = null;

  function step(/** @type {number} */ from) {
    frame = requestAnimationFrame((now) => {
      phase = ((now - from) / PERIOD_MS) % 1;
      move(phase);
      step(from);
    });
  }

  /** Lets the mode move or stand. */
  function update() {
    const moves = isWanted && isSeen;
    if (moves && frame === null) step(performance.now() - phase * PERIOD_MS);
    if (!moves && frame !== null) {
      cancelAnimationFrame(frame);
      frame = null;
    }
    root.dataset.moves = String(moves);
    button.textContent = isWanted ? "Pause" : "Move";
    button.setAttribute("aria-pressed", String(!isWanted));
  }

  /** In full deflection. */
  function stand() {
    phase = 0;
    move(0);
  }

  function choose() {
    const index = Number(select.value);
    move = drawMode(root, drawing, rotor.modes[index], nameOfMode(rotor.modes[index], index));
    if (frame === null) stand();
  }

  select.addEventListener("change", choose);
  button.addEventListener("click", () => {
    isWanted = !isWanted;
    update();
  });
  calm.addEventListener("change", () => {
    isWanted = !calm.matches;
    update();
    if (calm.matches) stand();
  });
  new IntersectionObserver(([{ isIntersecting }]) => {
    isSeen = isIntersecting;
    update();
  }).observe(root);
  window.addEventListener("beforeprint", () => {
    isWanted = false;
    update();
    stand();
  });
  choose();
  update();
}

/** @param {RotorMode} mode @param {number} index */
export const nameOfMode = (mode, index) => `mode ${index + 1}: ${number(mode.frequency_hz, 5)} Hz, ${mode.name}`;

/** In per cent with one decimal. @param {number | undefined} share */
const percent = (share) => number(Math.round(1000 * (share ?? 0)) / 10, 4);

/**
 * Number, frequency, damping, shares of the strain energy, the bearing that holds most, shares of the kinetic energy
 * and name of each mode.
 * @param {Rotor} rotor
 * @returns {string[][]}
 */
export function rotorRows({ modes }) {
  return modes.map((mode, index) => {
    const { strain_energy: strain, kinetic_energy: kinetic } = mode;
    const [bearing] = Object.entries(strain).filter(([name]) => name.includes("_bearing_")).sort((a, b) => b[1] - a[1]);
    const most = bearing && bearing[1] > 0.005 ? `${bearing[0].replace(/_bearing_(\d+)/, (_, at) => ` ${Number(at) + 1}`)}: ${percent(bearing[1])}` : "";
    return [
      String(index + 1), number(mode.frequency_hz, 5), number(100 * mode.damping_ratio, 3),
      `${percent(mode.strain_energy_mesh.left)} / ${percent(mode.strain_energy_mesh.right)}`, percent(mode.strain_energy_bearings), most,
      percent(strain.pinion_shaft), percent(strain.gear_shaft), percent(kinetic.lateral), percent(kinetic.axial), percent(kinetic.torsion), mode.name,
    ];
  });
}

/** @param {ResponseResult} response @returns {ValueRow[]} */
export function rotorValues(response) {
  const row = rowsFrom({ response });
  return [
    row("/response/rotor/mesh_stiffness_n_per_um/{half}", 4),
    row("/response/rotor/degrees_of_freedom"),
    row("/response/rotor/coordinates"),
    row("/response/rotor/modes_kept"),
    row("/response/rotor/static_corrections"),
    row("/response/rotor/reduction_error", 2),
    row("/response/rotor/highest_frequency_hz"),
    row("/response/rotor/rigid_body_modes"),
    ["Whirl frequencies at the speed", (response.rotor?.whirl_frequencies_hz ?? []).slice(0, 8).map((hertz) => number(hertz, 4)).join(", "), "Hz"],
  ];
}
