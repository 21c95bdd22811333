// Plots of the mesh-in impact.

import { line } from "../common/plot_traces.js";

const SAMPLES = 80;

/**
 * The pulse that excites the equations as a half sine, beside Zhou's of the same length.
 * @param {ImpactResult | null | undefined} impact
 * @param {number | null | undefined} meshFrequency
 * @returns {Plot | null}
 */
export function pulsePlot(impact, meshFrequency) {
  if (!impact || !meshFrequency || !(impact.force_n > 0) || !(impact.duration_us > 0) || !(meshFrequency > 0)) return null;
  const start = (impact.start_mesh_periods / meshFrequency) * 1e6;
  const { duration_us: length } = impact;
  // The pulse, and half its length of rest on both sides.
  const [from, to] = [start - 0.5 * length, start + 1.5 * length];
  const times = Array.from({ length: 2 * SAMPLES + 1 }, (_, index) => start + length * (index / SAMPLES - 0.5));
  /** @param {number} force */
  const pulse = (force) => times.map((time) => (time > start && time < start + length ? force * Math.sin((Math.PI * (time - start)) / length) : 0));
  const given = impact.source === "given";
  const traces = [line(times, pulse(impact.force_n), given ? "given" : "buffered")];
  if (impact.zhou2008_force_n && impact.zhou2008_force_n > 0) traces.push(line(times, pulse(impact.zhou2008_force_n), "Zhou 2008"));
  const marks = given ? [] : [{ x: start, text: "corner touches" }, { x: 0, text: "A" }].filter(({ x }) => x >= from && x <= to);
  return { traces, axes: { x: "Time from the theoretical start of contact A, µs", y: "Force, N", csvName: "mesh-in-impact", marks, range: [from, to] } };
}
