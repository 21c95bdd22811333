// Resonances in a sweep over the speed, and the Campbell diagram.

import { number } from "../common/format.js";

export const SPEED = "/operation/pinion_speed_rpm";
/** Crossings that are marked in other views: those that the mesh excites, of low orders. */
const MESH_SHARE = 0.1;
const HIGHEST_ORDER = 4;
const MOST_MARKED = 12;
/** Least distance of two labels, as a part of the range. */
const LABELS_APART = 0.022;

/**
 * The Campbell diagram of the line shown (of a sweep over two inputs, at the value of the other).
 * @param {JobResult | null} rest
 * @param {SweepView} view
 */
export function campbellAt(rest, view) {
  const all = rest?.sweep?.campbell ?? [];
  if (view.grid.axes.length === 1) return all[0] ?? null;
  if (view.grid.axes[0].pointer !== SPEED) return null;
  const value = view.grid.axes[1].values[view.line];
  return all.find(({ other_axis_value: other }) => other === value) ?? null;
}

/**
 * Speeds in a range at which a low order meets a mode of the mesh.
 * @param {JobResult | null} rest
 * @param {SweepView} view
 * @param {Span} range
 */
export function resonancesOf(rest, view, [from, to]) {
  if (view.grid.axes[0].pointer !== SPEED) return [];
  const diagram = campbellAt(rest, view);
  if (!diagram) return [];
  const found = diagram.crossings
    .filter(({ mesh_order: order, mesh_strain_energy: share, pinion_speed_rpm: at }) => order <= HIGHEST_ORDER && share >= MESH_SHARE && at >= from && at <= to)
    .sort((a, b) => b.mesh_strain_energy / b.mesh_order - a.mesh_strain_energy / a.mesh_order)
    .slice(0, MOST_MARKED)
    .map((crossing) => ({
      at: crossing.pinion_speed_rpm, order: crossing.mesh_order, mode: diagram.natural_modes[crossing.mode], share: crossing.mesh_strain_energy,
      label: `${crossing.mesh_order}·f<sub>m</sub> = ${number(crossing.frequency_hz, 4)} Hz`,
    }));
  // Of lines close to each other the stronger has a label.
  const apart = LABELS_APART * (to - from);
  found.forEach((line, index) => {
    if (found.slice(0, index).some((other) => other.label && Math.abs(other.at - line.at) < apart)) line.label = "";
  });
  return found;
}

/**
 * Natural frequencies against the orders of the mesh frequency.
 * @param {SweepState} sweep
 * @param {SweepView} view
 * @returns {Plot | null}
 */
export function campbell(sweep, view) {
  const diagram = campbellAt(sweep.rest, view);
  if (!diagram) return null;
  const [, speed] = diagram.pinion_speed_rpm;
  const [, mesh] = diagram.mesh_frequency_hz;
  const modes = diagram.natural_modes.filter((mode) => mode.frequency_hz > 0);
  const top = 1.08 * Math.max(...modes.map((mode) => mode.frequency_hz));
  /** @param {NaturalMode} mode */
  const share = (mode) => (mode.strain_energy.mesh_left ?? 0) + (mode.strain_energy.mesh_right ?? 0);
  /** @type {Trace[]} */
  const orders = diagram.mesh_orders.map((order) => {
    const end = Math.min(1, top / (order * mesh));
    return {
      type: "scatter", mode: "lines+text", x: [0, 0.94 * end * speed, end * speed], y: [0, 0.94 * end * order * mesh, end * order * mesh], text: ["", `${order}`, ""], textposition: "top left", showlegend: order === 1, name: "orders of the mesh frequency",
      hovertemplate: `order ${order}<br>%{x:.5~g} r/min, %{y:.5~g} Hz<extra></extra>`, paint: (/** @type {(name: string) => string} */ of) => ({ line: { color: of("--muted"), width: 1 }, textfont: { color: of("--muted"), size: 11 } }),
    };
  });
  const lines = modes.map((mode) => {
    const ofMesh = share(mode) >= MESH_SHARE;
    return {
      type: "scatter", mode: "lines", x: [0, speed], y: [mode.frequency_hz, mode.frequency_hz], showlegend: false,
      hovertemplate: `${mode.name}<br>${number(mode.frequency_hz)} Hz, ${Math.round(100 * share(mode))} % of the strain in the meshes<extra></extra>`,
      paint: (/** @type {(name: string) => string} */ of) => ({ line: { color: of(ofMesh ? "--plot-1" : "--plot-3"), width: ofMesh ? 2 : 1, dash: ofMesh ? "solid" : "dot" } }),
    };
  });
  const legend = [["modes of the mesh", true], ["other modes", false]].map(([name, ofMesh]) => ({
    type: "scatter", mode: "lines", x: [null], y: [null], name, showlegend: true, paint: (/** @type {(name: string) => string} */ of) => ({ line: { color: of(ofMesh ? "--plot-1" : "--plot-3"), width: ofMesh ? 2 : 1, dash: ofMesh ? "solid" : "dot" } }),
  }));
  const crossings = {
    type: "scatter", mode: "markers", name: "crossings (larger: more strain in the meshes)",
    x: diagram.crossings.map((crossing) => crossing.pinion_speed_rpm), y: diagram.crossings.map((crossing) => crossing.frequency_hz),
    text: diagram.crossings.map((crossing) => `order ${crossing.mesh_order} meets ${diagram.natural_modes[crossing.mode].name}`),
    hovertemplate: "%{text}<br>%{x:.5~g} r/min, %{y:.5~g} Hz<extra></extra>",
    paint: (/** @type {(name: string) => string} */ of) => ({ marker: { color: of("--plot-2"), size: diagram.crossings.map((crossing) => 5 + 11 * crossing.mesh_strain_energy), opacity: 0.85 } }),
  };
  return {
    traces: [...orders, ...lines, ...legend, crossings],
    axes: { x: "Pinion speed, r/min", y: "Frequency, Hz", name: "Natural frequencies against orders of the mesh frequency", csvName: `${sweep.name} Campbell`, hover: "closest", more: (layout) => { layout.xaxis.range = [0, 1.03 * speed]; layout.yaxis.range = [0, top]; } },
  };
}
