// Recorded lists of every point: the bifurcation diagram and the spectra.

import { campbellAt } from "./resonances.js";
import { hover, lookOf } from "./style.js";
import { rastered } from "./thin.js";

export const STATES = [
  { name: "poincare_x_left_m", label: "Displacement of the left mesh at the starts of mesh periods", unit: "µm", scale: 1e6 },
  { name: "poincare_v_x_left_m_s", label: "Velocity of the left mesh at the starts of mesh periods", unit: "m/s", scale: 1 },
];
export const SPECTRUM = "acceleration_spectrum_m_s2";
/** Points drawn one by one, and the raster on which more are drawn. */
const DRAWN = 6000;
const RASTER = [1100, 500];
/** Reference of levels of vibratory acceleration, m/s² (ISO 1683). */
const REFERENCE = 1e-6;
const BINS = 400;

/**
 * Each start of a mesh period is a point: one for a motion with period 1, n for period n, many for chaos.
 * @param {SweepState} sweep
 * @param {SweepView} view
 * @returns {Plot}
 */
export function bifurcation(sweep, view) {
  const { grid, state } = view;
  const axis = grid.axes[0];
  const column = sweep.data.column(state.name);
  const traces = grid.branches.map((branch, b) => {
    /** @type {number[][]} */
    const [x, y, positions] = [[], [], []];
    for (const first of grid.order) {
      const position = grid.at(first, view.line, b);
      for (const value of column[position] ?? []) {
        x.push(axis.values[first]);
        y.push(value * state.scale);
        positions.push(position);
      }
    }
    const kept = x.length > DRAWN ? rastered(x.length, (at) => x[at], (at) => y[at], RASTER) : [...x.keys()];
    const { colour } = lookOf(branch, "left");
    const fast = kept.length > DRAWN && hasWebGl();
    return {
      type: fast ? "scattergl" : "scatter", mode: "markers", name: branch, x: kept.map((at) => x[at]), y: kept.map((at) => y[at]), customdata: kept.map((at) => positions[at]), showlegend: Boolean(branch),
      hovertemplate: `${hover("", axis.unit, "x")}<br>${hover("", state.unit, "y")}<extra>${branch}</extra>`,
      paint: (/** @type {Paint} */ of) => ({ marker: { color: of(colour), size: branch === "down" ? 3 : 4, opacity: 0.75, symbol: branch === "down" ? "square" : "circle" } }),
    };
  });
  return {
    traces,
    axes: { x: axis.title, y: state.unit, name: state.label, csvName: `${sweep.name} bifurcation`, hover: "closest", click: view.click, more: (layout) => { if (axis.logarithmic) layout.xaxis.type = "log"; } },
  };
}

/** @typedef {(name: string) => string} Paint colour of the stylesheet by name */

/** @type {boolean | null} */
let webGl = null;
function hasWebGl() {
  webGl ??= Boolean(document.createElement("canvas").getContext("webgl"));
  return webGl;
}

/**
 * Amplitudes of the acceleration over the first axis, by mesh order or by frequency.
 * @param {SweepState} sweep
 * @param {SweepView} view
 * @returns {Plot}
 */
export function spectra(sweep, view) {
  const { grid } = view;
  const axis = grid.axes[0];
  const orders = sweep.orders ?? [];
  const column = sweep.data.column(SPECTRUM);
  const places = grid.order.filter((first) => column[grid.at(first, view.line, view.branch)]);
  const x = places.map((first) => axis.values[first]);
  const rows = places.map((first) => column[grid.at(first, view.line, view.branch)]);
  const diagram = campbellAt(sweep.rest, view);
  const perSpeed = diagram ? diagram.mesh_frequency_hz[1] / diagram.pinion_speed_rpm[1] : null;
  const inHertz = view.hertz && perSpeed !== null;
  /** @param {number} value */
  const level = (value) => (view.log ? 20 * Math.log10(value / REFERENCE) : value);
  let y = orders;
  /** @type {(number | null)[][]} */
  let z = orders.map((_, at) => rows.map((row) => level(row[at])));
  if (inHertz) {
    const top = orders[orders.length - 1] * perSpeed * x[x.length - 1];
    y = Array.from({ length: BINS }, (_, bin) => ((bin + 0.5) * top) / BINS);
    const step = orders[1] - orders[0];
    z = y.map((hertz) => rows.map((row, at) => {
      const place = Math.round((hertz / (perSpeed * x[at]) - orders[0]) / step);
      return place >= 0 && place < row.length ? level(row[place]) : null;
    }));
  }
  const unit = view.log ? "dB" : "m/s²";
  const highest = y[y.length - 1];
  /** @type {Trace[]} */
  const traces = [{
    type: "heatmap", x, y, z, unit, colorscale: "Viridis", hoverongaps: false, colorbar: { title: { text: unit }, thickness: 14, outlinewidth: 0 },
    customdata: y.map(() => places.map((first) => grid.at(first, view.line, view.branch))),
    hovertemplate: `${hover("", axis.unit, "x")}<br>${inHertz ? "%{y:.5~g} Hz" : "order %{y}"}<br>%{z:.4~g} ${unit}<extra></extra>`,
    ...(view.log ? cutBelow(z) : {}), paint: () => ({}),
  }];
  if (view.resonances && diagram && perSpeed !== null) traces.push(...overlay(diagram, inHertz, x, highest, perSpeed));
  const branch = grid.branches[view.branch];
  return {
    traces,
    axes: {
      x: axis.title, y: inHertz ? "Frequency, Hz" : "Mesh order", csvName: `${sweep.name} spectra`, hover: "closest", click: view.click,
      name: ["Circumferential acceleration of the left half, amplitude", view.log ? "dB re 1 µm/s²" : "m/s²", branch].filter(Boolean).join(", "),
      more: (layout) => { if (axis.logarithmic) layout.xaxis.type = "log"; layout.yaxis.range = [0, highest]; layout.yaxis.exponentformat = "none"; },
    },
  };
}

/**
 * Values 80 dB below the strongest line, and those of no amplitude, are drawn as that level.
 * @param {(number | null)[][]} z
 */
function cutBelow(z) {
  let top = -Infinity;
  for (const row of z) for (const value of row) if (value !== null && value > top) top = value;
  if (!Number.isFinite(top)) return {};
  const least = top - 80;
  for (const row of z) row.forEach((value, at) => { if (value !== null && value < least) row[at] = least; });
  return { zmin: least, zmax: top };
}

/**
 * Natural frequencies of the mesh modes, and over frequency the orders 1 to 4.
 * @param {CampbellDiagram} diagram
 * @param {boolean} inHertz
 * @param {number[]} x
 * @param {number} top
 * @param {number} perSpeed mesh frequency per unit of speed
 * @returns {Trace[]}
 */
function overlay(diagram, inHertz, x, top, perSpeed) {
  const paint = () => ({ line: { color: "rgba(255,255,255,.8)", width: 1, dash: "dot" } });
  const base = { type: "scatter", mode: "lines", showlegend: false, aside: true, paint };
  /** @param {NaturalMode} mode */
  const share = (mode) => (mode.strain_energy.mesh_left ?? 0) + (mode.strain_energy.mesh_right ?? 0);
  const modes = diagram.natural_modes.filter((mode) => mode.frequency_hz > 0 && share(mode) >= 0.1);
  const lines = modes.map((mode) => ({
    ...base, x, y: x.map((speed) => (inHertz ? mode.frequency_hz : mode.frequency_hz / (perSpeed * speed))), hovertemplate: `${mode.name}<br>%{y:.5~g}<extra></extra>`,
  }));
  const orders = inHertz ? [1, 2, 3, 4].map((order) => ({ ...base, x, y: x.map((speed) => order * perSpeed * speed), hovertemplate: `order ${order}<extra></extra>` })) : [];
  return [...lines, ...orders].map((trace) => ({ ...trace, y: trace.y.map((value) => (value <= top ? value : null)) }));
}
