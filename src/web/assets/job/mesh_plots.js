// Plots of the mesh, from the result: stiffness, transmission error, load sharing, load on the flank. Each is {
// traces, axes }, or null where the result has nothing for it.

import { number } from "../common/format.js";
import { bars, heatMap, line, points } from "../common/plot_traces.js";

const PHASE = "Position in the mesh period";
/** A pair is looked at so far after its start, in base pitches, for its share at mesh-in. */
const MESH_IN = 0.05;

/** @param {MeshResult} mesh @returns {[string, MeshCurve][]} */
const halves = ({ curve, right_curve: right }) => (right ? [["left", curve], ["right", right]] : [["", curve]]);
/** The first value again at 1: a mesh period begins where the last one ended. @param {number[]} values */
const closed = (values) => [...values, values[0]];
/** @param {MeshCurve} curve */
const phaseOf = ({ phase }) => [...phase, phase[0] + 1];
/** @param {number[]} values */
const mean = (values) => values.reduce((sum, value) => sum + value, 0) / values.length;

/** @param {MeshResult | null | undefined} mesh @returns {Plot | null} */
export function stiffnessPlot(mesh) {
  if (!mesh?.curve?.stiffness_n_per_um?.length) return null;
  const solved = mesh.source === "ltca";
  const traces = halves(mesh).map(([half, curve]) => line(phaseOf(curve), closed(curve.stiffness_n_per_um), [solved ? "tangent dF/dδ" : "", half].filter(Boolean).join(", ")));
  // With equal load of both halves the secant follows from the deflection.
  const secant = mesh.right_curve ? [] : mesh.curve.transmission_error_um.map((error) => mesh.force_n / error);
  if (solved && secant.length && Math.abs(mean(secant) / mesh.secant_stiffness_mean_n_per_um - 1) < 0.01) traces.push(line(phaseOf(mesh.curve), closed(secant), `secant F/δ, mean ${number(mesh.secant_stiffness_mean_n_per_um, 4)}`));
  const levels = [{ y: mesh.stiffness_mean_n_per_um, text: `mean ${number(mesh.stiffness_mean_n_per_um, 4)}` }];
  return { traces, axes: { x: PHASE, y: "Mesh stiffness, N/µm", csvName: "mesh-stiffness", range: [0, 1], levels, link: "mesh" } };
}

/** @param {MeshResult | null | undefined} mesh @returns {Plot | null} */
export function errorPlot(mesh) {
  if (!mesh?.curve?.transmission_error_um?.length) return null;
  const traces = halves(mesh).map(([half, curve]) => line(phaseOf(curve), closed(curve.transmission_error_um), half));
  /** @type {PlotAxes} */
  const axes = { x: PHASE, y: "Transmission error, µm", csvName: "transmission-error", range: [0, 1], link: "mesh" };
  if (!mesh.right_curve) axes.levels = [{ y: mesh.transmission_error_mean_um, text: `mean ${number(mesh.transmission_error_mean_um, 4)}` }];
  else apart(mesh, traces, axes);
  return { traces, axes };
}

/**
 * Separate axes of equal length for the halves, if an assembly error separates their curves by much more than the
 * curves vary.
 * @param {MeshResult} mesh
 * @param {Trace[]} traces
 * @param {PlotAxes} axes
 */
function apart({ curve, right_curve: right }, traces, axes) {
  if (!right) return;
  const ends = [curve, right].map(({ transmission_error_um: values }) => [Math.min(...values), Math.max(...values)]);
  const span = 1.2 * Math.max(...ends.map(([low, high]) => high - low));
  const middles = ends.map(([low, high]) => (low + high) / 2);
  if (Math.abs(middles[0] - middles[1]) < 2 * span) return;
  const [range, range2] = middles.map((middle) => [middle - span / 2, middle + span / 2]);
  traces[1].yaxis = "y2";
  Object.assign(axes, { y: "Transmission error, left, µm", y2: "right, µm", yRange: range, y2Range: range2 });
}

/** @param {MeshResult | null | undefined} mesh @returns {Plot | null} */
export function harmonicsPlot(mesh) {
  const amplitudes = mesh?.transmission_error_harmonics_um;
  if (!amplitudes?.length) return null;
  const orders = amplitudes.map((_, index) => index + 1);
  return { traces: [bars(orders, amplitudes)], axes: { x: "Mesh order", y: "Amplitude, µm", csvName: "transmission-error-harmonics", layout: { bargap: .5 } } };
}

/** @param {MeshResult | null | undefined} mesh @param {GearData | null} gearData @returns {Plot | null} */
export function sharePlot(mesh, gearData) {
  if (!mesh?.curve?.load_share?.[0]?.length) return null;
  const traces = halves(mesh).map(([half, curve]) => line(curve.load_share_phase, positive(curve.load_share[0]), half));
  const marks = (gearData?.path_points ?? []).map(({ name, base_pitches: x }) => ({ x, text: name }));
  if (gearData && gearData.overlap_ratio > 0.01) marks.push({ x: gearData.total_contact_ratio, text: "end" });
  if (typeof mesh.load_share_at_mesh_in === "number") traces.push({ ...points([MESH_IN], [mesh.load_share_at_mesh_in], "mesh-in"), colour: 3 });
  return { traces, axes: { x: "Base pitches since the theoretical start of contact", y: "Share of the load", csvName: "load-share", marks, hover: "closest" } };
}

/** Values where nothing touches are zeros, some of them negative ones. @param {number[]} values */
const positive = (values) => values.map((value) => (value > 0 ? value : 0));

/**
 * Every pair in mesh over one mesh period: one pair's path, cut into base pitches.
 * @param {MeshResult | null | undefined} mesh
 * @returns {Plot | null}
 */
export function sharingPlot(mesh) {
  if (!mesh) return null;
  const { load_share: shares = [], load_share_phase: phase = [] } = mesh.curve;
  if (!shares[0]?.length) return null;
  /** @param {number} place */
  const at = (place) => {
    const next = phase.findIndex((x) => x >= place);
    if (next < 0) return 0;
    if (next === 0) return place < phase[0] ? 0 : shares[0][0];
    const part = (place - phase[next - 1]) / (phase[next] - phase[next - 1]);
    return shares[0][next - 1] * (1 - part) + shares[0][next] * part;
  };
  const steps = Array.from({ length: 101 }, (_, index) => index / 100);
  const traces = [];
  for (let pair = Math.floor(phase[0]); pair < phase[phase.length - 1]; pair += 1) {
    const values = positive(steps.map((step) => at(step + pair)));
    if (Math.max(...values) > 1e-4) traces.push({ ...line(steps, values, nameOfPair(pair)), stackgroup: "pairs" });
  }
  const half = mesh.right_curve ? " of the left half" : "";
  return { traces: traces.reverse(), axes: { x: PHASE, y: "Share of the load", name: `Sharing of the load between all pairs${half}`, csvName: "load-sharing", range: [0, 1], yRange: [0, 1.001], link: "mesh", hover: "x unified" } };
}

/** Pairs by when they entered; the next one touches early, at its corner. @param {number} pair */
const nameOfPair = (pair) => (pair < 0 ? "next pair" : ["entering pair", "2nd", "3rd"][pair] ?? `${pair + 1}th`);

/**
 * Line load on the flanks of one tooth of the pinion, both halves, true to scale: along the axis and along the path of
 * contact, with the lines of contact.
 * @param {MeshResult | null | undefined} mesh
 * @param {GearData | null} gearData
 * @returns {Plot | null}
 */
export function flankPlot(mesh, gearData) {
  const left = mesh?.curve.flank;
  if (!left?.line_load_n_per_mm.length) return null;
  const right = mesh?.right_curve?.flank ?? left;
  const { face_width_mm: width = left.face_mm[0] + left.face_mm[left.face_mm.length - 1], gap_width_mm: gap = 0 } = gearData ?? {};
  const most = Math.max(...[left, right].flatMap(({ line_load_n_per_mm: load }) => load.flat()));
  /** @param {number} side -1 left, 1 right @param {number} face distance from the inner end */
  const place = (side, face) => side * (gap / 2 + face);
  /** @param {number} side @param {FlankLoad} flank @param {string} name */
  const map = (side, flank, name) => {
    const faces = side < 0 ? [...flank.face_mm].reverse() : flank.face_mm;
    const rows = flank.line_load_n_per_mm.map((row) => (side < 0 ? [...row].reverse() : row));
    return { ...heatMap(faces.map((face) => place(side, face)), flank.roll_mm, rows, "N/mm"), name, zmin: 0, zmax: most, showscale: side > 0 };
  };
  const { side, flank, row, column } = greatest(left, right, most);
  const mark = { size: 12, symbol: "circle-open", color: "#ffffff", line: { width: 2, color: "#ffffff" } };
  /** @type {Trace[]} */
  const traces = [
    map(-1, left, "left half"), map(1, right, "right half"),
    ...(gearData?.contact_lines ?? []).map(({ axial_mm: axial, roll_mm: roll }) => ({ ...line(axial, roll), aside: true, hoverinfo: "skip", line: { width: 1.2, color: "#ffffff", dash: "dash" } })),
    { ...points([place(side, flank.face_mm[column])], [flank.roll_mm[row]], ""), aside: true, hovertemplate: `greatest: ${number(most, 4)} N/mm<extra></extra>`, marker: mark },
  ];
  return {
    traces,
    axes: {
      x: "Along the axis, mm", y: "Roll path of the pinion, mm", z: "Line load", csvName: "line-load", equal: true, hover: "closest",
      annotations: [-1, 1].map((side) => ({ x: side * (gap + width) / 2, y: 1, yref: "paper", yanchor: "bottom", text: side < 0 ? "left half" : "right half", showarrow: false })),
      layout: { margin: { l: 56, r: 16, t: 28, b: 44 } },
    },
  };
}

/** The cell with the greatest load. @param {FlankLoad} left @param {FlankLoad} right @param {number} most */
function greatest(left, right, most) {
  for (const [side, flank] of /** @type {[number, FlankLoad][]} */ ([[-1, left], [1, right]])) {
    for (const [row, loads] of flank.line_load_n_per_mm.entries()) {
      const column = loads.indexOf(most);
      if (column >= 0) return { side, flank, row, column };
    }
  }
  return { side: -1, flank: left, row: 0, column: 0 };
}
