// The traces of plots. `tone: "muted"` sets one back; `colour` (from 0) takes another colour than that of its place;
// `aside` leaves it out of the data's table and files; `paint(colour)` gives what of it has colours of its own,
// `colour("--name")` being one of the stylesheet.

/** A curve. @type {(x: any[], y: any[], name?: string) => Trace} */
export const line = (x, y, name = "") => ({ type: "scatter", mode: "lines", x, y, name, line: { width: 1.8 }, showlegend: Boolean(name) });

/** Points without a line. @type {(x: any[], y: any[], name?: string) => Trace} */
export const points = (x, y, name = "") => ({ type: "scatter", mode: "markers", x, y, name, marker: { size: 7, symbol: "circle-open", line: { width: 2 } }, showlegend: Boolean(name) });

/**
 * Vertical lines from zero with a point at their ends.
 * @param {number[]} x
 * @param {number[]} y
 * @returns {Trace}
 */
export function stems(x, y, name = "") {
  const lengths = { type: "data", symmetric: false, array: x.map(() => 0), arrayminus: y, width: 0, thickness: 1.6 };
  return { ...points(x, y, name), showlegend: false, marker: { size: 5 }, error_y: lengths };
}

/** @type {(x: any[], y: any[], name?: string) => Trace} */
export const bars = (x, y, name = "") => ({ type: "bar", x, y, name, showlegend: Boolean(name) });

/** A map of `z` (rows over y) in the unit `unit`. @type {(x: any[], y: any[], z: any[][], unit: string) => Trace} */
export const heatMap = (x, y, z, unit) => ({ type: "heatmap", x, y, z, unit, colorbar: { title: { text: unit }, thickness: 14, outlinewidth: 0 }, colorscale: "Viridis", hoverongaps: false });
