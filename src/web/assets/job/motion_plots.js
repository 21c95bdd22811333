// Plots of the motion that need only the result: spectrum and natural modes.

import { number } from "../common/format.js";
import { line, points, stems } from "../common/plot_traces.js";

/** Reference of levels of acceleration (ISO 1683), m/s². */
const REFERENCE = 1e-6;
/** Levels shown below the greatest, dB. */
const DEPTH = 100;
/** Modes with less of their strain energy in the meshes are hardly excited by them. */
const EXCITED = 0.01;
/** Mesh orders that excitation is looked for in. */
const ORDERS = 20;

/** Level of an acceleration, dB. @param {number} amplitude m/s² */
const levelOf = (amplitude) => 20 * Math.log10(Math.max(amplitude, 1e-300) / REFERENCE);

/**
 * Amplitudes of the left half's circumferential acceleration over mesh orders; `decibel` shows levels.
 * @param {ResponseResult | null | undefined} response
 * @param {Numerics} numerics
 * @param {{ decibel?: boolean }} [options]
 * @returns {Plot | null}
 */
export function spectrumPlot(response, numerics, { decibel = false } = {}) {
  if (!response) return null;
  const { spectrum, mesh_frequency_hz: mesh } = response;
  if (!spectrum?.frequency_hz.length || !(mesh > 0)) return null;
  const orders = spectrum.frequency_hz.map((hertz) => hertz / mesh);
  const top = decibel ? levelOf(Math.max(...spectrum.amplitude_m_s2)) : 0;
  const floor = Math.floor((top - DEPTH) / 10) * 10;
  const shown = spectrum.amplitude_m_s2.map((amplitude) => (decibel ? Math.max(floor, levelOf(amplitude)) : amplitude));
  const lines = stems(orders, shown);
  lines.error_y.arrayminus = shown.map((value) => value - (decibel ? floor : 0));
  // Thousands of lines need no dots, except the greatest.
  if (orders.length > 200) Object.assign(lines, { marker: { size: 1 }, error_y: { ...lines.error_y, thickness: 1 } });
  lines.customdata = spectrum.frequency_hz;
  lines.hovertemplate = `order %{x:.5~g}, %{customdata:.6~g} Hz<br>%{y:.5~g} ${decibel ? "dB" : "m/s²"}<extra></extra>`;
  const modes = excitedModes(response, numerics).filter(({ frequency_hz: hertz }) => hertz < ORDERS * mesh);
  // One below the other, where they lie close.
  const marks = modes.map(({ index, frequency_hz: hertz }, at) => ({ x: hertz / mesh, text: `mode ${index}`, at: 1 - 0.08 * (at % 4) }));
  const end = Math.max(...orders) + 0.5;
  return {
    traces: [lines],
    axes: {
      x: "Mesh order", y: decibel ? "Level re 1 µm/s², dB" : "Acceleration, m/s²", csvName: "spectrum", range: [0, end], marks: marks.slice(0, 12), hover: "closest",
      top: { title: "Frequency, Hz", factor: mesh },
      yRange: decibel ? [floor, top + 5] : [0, 1.08 * Math.max(...shown)],
    },
  };
}

/**
 * The strongest lines of the spectrum, at mesh orders or between them.
 * @param {ResponseResult} response
 */
export function strongestLines({ spectrum, mesh_frequency_hz: mesh }, count = 8) {
  if (!spectrum?.frequency_hz?.length) return [];
  const all = spectrum.frequency_hz.map((hertz, at) => ({ hertz, order: hertz / mesh, amplitude: spectrum.amplitude_m_s2[at] }));
  return all.sort((a, b) => b.amplitude - a.amplitude).slice(0, count);
}

/** An order as text: 3, 1/2, 5/2, 1.37. @param {number} order @param {number | null} [periods] */
export function orderWords(order, periods = 1) {
  for (const parts of [1, periods ?? 1]) {
    const times = order * parts;
    if (Math.abs(times - Math.round(times)) < 1e-3) return parts === 1 || Math.round(times) % parts === 0 ? String(Math.round(order)) : `${Math.round(times)}/${parts}`;
  }
  return number(order, 4);
}

/** Share of a mode's strain energy in the meshes. @param {NaturalMode} mode */
export const meshShare = ({ strain_energy: energy }) => (energy?.mesh_left ?? 0) + (energy?.mesh_right ?? 0);

/** Whether the halves move against each other in a mode: equal halves do not excite it. @param {NaturalMode} mode */
const isOpposed = ({ name }) => name.endsWith("opposed");
/** Whether the halves mirror each other, so that half of the equations was solved. @param {Numerics} [numerics] */
export const halvesAlike = (numerics) => numerics?.degrees_of_freedom === 6;

/**
 * Modes that the mesh excites, with their number in the list, from 1.
 * @param {ResponseResult} response
 * @param {Numerics} numerics
 */
const excitedModes = ({ natural_modes: modes = [] }, numerics) =>
  modes.map((mode, at) => ({ ...mode, index: at + 1 })).filter((mode) => mode.frequency_hz > 0 && meshShare(mode) >= EXCITED && !(halvesAlike(numerics) && isOpposed(mode)));

/**
 * Of a mode, the mesh order that lies nearest to it: { order, ratio } with ratio = order·f_mesh / f_mode.
 * @param {number} hertz
 * @param {number} mesh
 */
export function nearestOrder(hertz, mesh) {
  if (!(hertz > 0) || !(mesh > 0)) return null;
  const exact = hertz / mesh;
  const candidates = [Math.floor(exact), Math.ceil(exact)].map((order) => Math.min(ORDERS, Math.max(1, order)));
  const order = candidates.reduce((best, candidate) => (Math.abs(candidate / exact - 1) < Math.abs(best / exact - 1) ? candidate : best));
  return { order, ratio: order / exact };
}

/** The excited mode that a mesh order is nearest to. @param {ResponseResult} response @param {Numerics} numerics */
export function nearestResonance(response, numerics) {
  const all = excitedModes(response, numerics).flatMap((mode) => {
    const nearest = nearestOrder(mode.frequency_hz, response.mesh_frequency_hz);
    return nearest ? [{ mode, ...nearest }] : [];
  });
  return all.length ? all.reduce((best, next) => (Math.abs(next.ratio - 1) < Math.abs(best.ratio - 1) ? next : best)) : null;
}

/**
 * Natural modes by frequency, as high as the meshes' share of their strain energy, against the mesh orders.
 * @param {ResponseResult | null | undefined} response
 * @param {Numerics} numerics
 * @returns {Plot | null}
 */
export function modesPlot(response, numerics) {
  if (!response) return null;
  const { natural_modes: modes = [], mesh_frequency_hz: mesh } = response;
  const held = modes.map((mode, at) => ({ ...mode, index: at + 1 })).filter((mode) => mode.frequency_hz > 0);
  if (!held.length || !(mesh > 0)) return null;
  const end = 1.06 * Math.max(...held.map((mode) => mode.frequency_hz));
  const orders = Array.from({ length: Math.min(ORDERS, Math.floor(end / mesh)) }, (_, at) => at + 1);
  const close = (at, other) => held[other] && Math.abs(held[other].frequency_hz - held[at].frequency_hz) < 0.02 * end;
  const side = (at) => (close(at, at + 1) ? "top left" : close(at, at - 1) ? "top right" : "top center");
  const traceOf = (wanted, look) => {
    const shown = held.map((mode, at) => ({ ...mode, side: side(at) })).filter(wanted);
    const trace = stems(shown.map((mode) => mode.frequency_hz), shown.map((mode) => 100 * meshShare(mode)), look.name);
    Object.assign(trace, { ...look, mode: "markers+text", text: shown.map((mode) => String(mode.index)), textposition: shown.map((mode) => mode.side), error_y: { ...trace.error_y, thickness: 2.5 }, cliponaxis: false });
    trace.customdata = shown.map((mode) => `${mode.index}: ${mode.name}`);
    trace.hovertemplate = "mode %{customdata}<br>%{x:.5~g} Hz<br>%{y:.3~g} % of its strain energy in the meshes<extra></extra>";
    return trace;
  };
  const idle = (mode) => halvesAlike(numerics) && isOpposed(mode);
  const traces = [traceOf((mode) => !idle(mode), { name: "excited", marker: { size: 8, symbol: "circle" }, showlegend: held.some(idle) })];
  if (held.some(idle)) traces.push(traceOf(idle, { name: "not excited: equal halves", tone: "muted", marker: { size: 8, symbol: "circle-open", line: { width: 2 } }, showlegend: true }));
  return {
    traces,
    axes: {
      x: "Frequency, Hz", y: "Strain energy in the meshes, %", csvName: "natural-modes", hover: "closest", range: [0, end], yRange: [0, 112],
      marks: orders.map((order) => ({ x: order * mesh, text: orders.length <= 12 || order % 2 === 1 ? `${order}×` : "", dash: "solid" })),
    },
  };
}

/**
 * The motion in the phase plane; `edge` is half the backlash, where the displacement is the normal one.
 * @param {{ half: string, place: number[], velocity: number[], dots?: { place: number[], velocity: number[] } }[]}
 * paths
 * @param {{ x: string, y: string, edge?: number | null }} options
 * @returns {Plot}
 */
export function phasePlot(paths, { x, y, edge = null }) {
  const traces = paths.flatMap(({ half, place, velocity, dots }, index) => [
    { ...line(place, velocity, half), colour: index, line: { width: 1.4, dash: index ? "dash" : "solid" } },
    ...(dots?.place.length ? [{ ...points(dots.place, dots.velocity, paths.length > 1 ? `${half}, once per mesh period` : "once per mesh period"), colour: index, marker: { size: dots.place.length > 20 ? 4 : 8, symbol: index ? "square-open" : "circle-open", line: { width: 2 } } }] : []),
  ]);
  const places = paths.flatMap(({ place }) => place);
  const [low, high] = [places.reduce((a, b) => Math.min(a, b), Infinity), places.reduce((a, b) => Math.max(a, b), -Infinity)];
  const margin = 0.06 * (high - low || 1);
  const near = edge === null ? [] : [edge, -edge].filter((at) => at > low - (high - low) && at < high + (high - low));
  /** @type {PlotAxes} */
  const axes = { x, y, hover: "closest", marks: near.map((at) => ({ x: at, text: at < 0 ? "−b: back flanks" : "b: flanks touch", dash: "dash" })), csvName: "phase-plane" };
  if (near.length) axes.range = [Math.min(low, ...near) - margin, Math.max(high, ...near) + margin];
  return { traces, axes };
}
