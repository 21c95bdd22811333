// Plots of both halves on their shafts, from the result: line load along the faces, deflections, face load factors over
// the torque, bearing forces. Each is { traces, axes }, or null where the result has nothing for it.

import { number } from "../common/format.js";
import { bars, line, points } from "../common/plot_traces.js";

/** @typedef {NonNullable<PairDrawing["shafts"]>} ShaftsDrawing */

const AXIAL = "From the middle of the gap, mm";
export const MEMBERS = /** @type {const} */ (["pinion", "gear"]);
const HALVES = /** @type {const} */ (["left", "right"]);

/**
 * Line load along the faces of both halves: of each station, means over pieces of 5 mm, the mean.
 * @param {ShaftsResult | null | undefined} shafts
 * @param {GearData | null} gearData
 * @returns {Plot | null}
 */
export function faceLoadPlot(shafts, gearData) {
  if (!shafts?.left.station_from_inner_end_mm.length || !gearData) return null;
  const { face_width_mm: width, gap_width_mm: gap } = gearData;
  /** @param {"left" | "right"} half @param {number} inner from the inner end */
  const place = (half, inner) => (half === "left" ? -1 : 1) * (gap / 2 + inner);
  const traces = HALVES.flatMap((half, index) => {
    const { station_from_inner_end_mm: stations, line_load_n_per_mm: load, line_load_5mm_means_n_per_mm: means, ...ends } = shafts[half];
    const places = [0, ...stations, width].map((inner) => place(half, inner));
    const loads = [ends.line_load_inner_end_n_per_mm, ...load, ends.line_load_outer_end_n_per_mm];
    const order = half === "left" ? [places.reverse(), loads.reverse()] : [places, loads];
    return [
      { ...line(order[0], order[1], `${half} half`), colour: index },
      { ...points(stations.map((inner) => place(half, inner)), means, `${half} half, means over 5 mm`), colour: index, marker: { size: 6, symbol: "square-open", line: { width: 1.6 } } },
    ];
  });
  return {
    traces,
    axes: {
      x: AXIAL, y: "Line load, N/mm", csvName: "line-load-along-the-faces", hover: "closest",
      levels: [{ y: shafts.line_load_mean_n_per_mm, text: `mean ${number(shafts.line_load_mean_n_per_mm, 4)} N/mm` }],
      more: (layout) => { layout.yaxis.rangemode = "tozero"; },
    },
  };
}

/** @typedef {NonNullable<ShaftsResult["pinion"]["deflection"]>} Deflection */

/** Displacements of a shaft's centre line. @param {ShaftsResult["pinion"]} shaft @returns {Deflection} */
export const deflectionOf = ({ deflection }) => deflection ?? { station_mm: [], x_um: [], y_um: [], z_um: [], twist_from_coupling_urad: [] };

/** Place of the left end of a shaft, from the middle of the gap. @param {ShaftsDrawing["pinion"]} shaft */
export const leftEnd = (shaft) => Math.min(...shaft.segments.flatMap((segment) => segment.axial_mm));

/**
 * Deflected centre lines in both planes.
 * @param {ShaftsResult | null | undefined} shafts
 * @param {ShaftsDrawing | null | undefined} drawing
 * @returns {Plot | null}
 */
export function deflectionPlot(shafts, drawing) {
  return alongShafts(shafts, drawing, (member, { x_um: x, y_um: y }) => [[`${member}, x`, x], [`${member}, y`, y]], { y: "Displacement, µm", csvName: "shaft-deflection" });
}

/**
 * Twist of each shaft from its coupling.
 * @param {ShaftsResult | null | undefined} shafts
 * @param {ShaftsDrawing | null | undefined} drawing
 * @returns {Plot | null}
 */
export function twistPlot(shafts, drawing) {
  return alongShafts(shafts, drawing, (member, { twist_from_coupling_urad: twist }) => [[member, twist]], { y: "Twist from the coupling, µrad", csvName: "shaft-twist" });
}

/**
 * @param {ShaftsResult | null | undefined} shafts
 * @param {ShaftsDrawing | null | undefined} drawing
 * @param {(member: string, deflection: Deflection) => [string, number[]][]} pick
 * @param {PlotAxes} axes
 * @returns {Plot | null}
 */
function alongShafts(shafts, drawing, pick, axes) {
  if (!shafts || !drawing) return null;
  const traces = MEMBERS.flatMap((member) => {
    const deflection = deflectionOf(shafts[member]);
    const places = deflection.station_mm.map((station) => station + leftEnd(drawing[member]));
    return pick(member, deflection).map(([name, values]) => line(places, values, name));
  });
  return traces.some(({ x }) => x.length) ? { traces, axes: { x: AXIAL, link: "shafts", hover: "closest", ...axes } } : null;
}

/**
 * Face load factors over the torque, as designed and with the proposed helix modifications.
 * @param {ShaftsResult | null | undefined} shafts
 * @param {number} [torque] of the document
 * @returns {Plot | null}
 */
export function torquePlot(shafts, torque) {
  if (!shafts?.at_torques?.length) return null;
  const torques = shafts.at_torques.map((one) => one.pinion_torque_nm);
  const isSought = HALVES.some((half) => shafts[half].helix_modification);
  /** @param {"k_h_beta_5mm" | "k_h_beta_5mm_modified"} key @param {string} words @param {Record<string, any>} style */
  const both = (key, words, style) => HALVES.map((half, colour) => ({ ...line(torques, (shafts.at_torques ?? []).map((one) => one[key][half]), `${half}, ${words}`), mode: "lines+markers", colour, ...style }));
  /** @type {Trace[]} */
  const traces = both("k_h_beta_5mm", "as designed", { line: { width: 1.8, dash: "solid" } });
  if (isSought) traces.push(...both("k_h_beta_5mm_modified", "with the modification", { line: { width: 1.8, dash: "dash" } }));
  if (shafts.iso6336 && typeof torque === "number") traces.push({ ...points([Math.abs(torque)], [shafts.iso6336.k_h_beta], `ISO 6336-1, ${shafts.iso6336.half} half`), colour: 3, marker: { size: 10, symbol: "diamond-open", line: { width: 2 } } });
  const marks = typeof torque === "number" ? [{ x: Math.abs(torque) }] : [];
  return { traces, axes: { x: "Torque of the pinion, N·m", y: "K_Hβ, means over 5 mm", csvName: "face-load-factor-over-torque", marks, hover: "closest" } };
}

/** Name of a bearing: "pinion bearing 1". @param {BearingForce} bearing */
export const nameOfBearing = ({ shaft, index }) => `${shaft} bearing ${index + 1}`;

/**
 * Amplitudes of the bearing forces along one axis by mesh order.
 * @param {ResponseResult | null | undefined} response
 * @param {"x" | "y" | "z"} axis
 * @returns {Plot | null}
 */
export function bearingOrdersPlot(response, axis) {
  const moved = (response?.bearings ?? []).filter((bearing) => bearing.force_n[axis].amplitudes.some((amplitude) => amplitude > 0));
  if (!moved.length) return null;
  const traces = moved.map((bearing) => {
    const { amplitudes } = bearing.force_n[axis];
    return bars(amplitudes.map((_, order) => order + 1), amplitudes, nameOfBearing(bearing));
  });
  return { traces, axes: { x: "Mesh order", y: "Amplitude, N", csvName: `bearing-force-orders-${axis}`, layout: { barmode: "group", bargap: .3 } } };
}

/** Axes along which a bearing force vibrates. @param {ResponseResult | null | undefined} response */
export const movedAxes = (response) => /** @type {const} */ (["x", "y", "z"]).filter((axis) => bearingOrdersPlot(response, axis));
