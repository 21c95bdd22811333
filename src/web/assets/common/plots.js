// Plots with Plotly: loaded on first use, coloured by the stylesheet, redrawn when light turns dark.

import { byId, el } from "./dom.js";

const CONFIG = { displaylogo: false, modeBarButtonsToRemove: ["select2d", "lasso2d"], toImageButtonOptions: { scale: 2 } };
const drawn = new Map();
let loading = null;

/** Plots follow the width of their boxes. */
const fit = new ResizeObserver((changes) => {
  for (const { target, contentRect } of changes) {
    const width = target._fullLayout?.width;
    if (contentRect.width > 0 && width && Math.abs(width - contentRect.width) > 1) window.Plotly.Plots.resize(target);
  }
});

/**
 * Plotly writes some style attributes as text, which the content security policy forbids; through the style object
 * they are allowed, so that the policy needs no exception.
 */
function allowStyleAttributes() {
  const { setAttribute } = Element.prototype;
  Element.prototype.setAttribute = function (name, value) {
    if (name === "style" && this.style) this.style.cssText = value;
    else setAttribute.call(this, name, value);
  };
}

function load() {
  loading ??= new Promise((resolve, reject) => {
    allowStyleAttributes();
    const script = el("script", { src: byId("job").dataset.plotly, async: true });
    script.addEventListener("load", () => resolve(window.Plotly));
    script.addEventListener("error", () => reject(new Error("The plotting script could not be loaded")));
    document.head.append(script);
  });
  return loading;
}

export const line = (x, y, name) => ({ type: "scatter", mode: "lines", x, y, name, line: { width: 1.6 }, showlegend: Boolean(name) });

export const points = (x, y, name) => ({ type: "scatter", mode: "markers", x, y, name, marker: { size: 7, symbol: "circle-open", line: { width: 2 } } });

/** Vertical lines from zero with a point at their ends. */
export function stems(x, y, name) {
  const ends = points(x, y, name);
  const lengths = { type: "data", symmetric: false, array: x.map(() => 0), arrayminus: y, width: 0, thickness: 1.6 };
  return { ...ends, showlegend: false, marker: { size: 5 }, error_y: lengths };
}

export const heatMap = (x, y, z, unit) => ({ type: "heatmap", x, y, z, colorbar: { title: { text: unit }, thickness: 14, outlinewidth: 0 }, colorscale: "Viridis", hoverongaps: false });

/** Draws traces into a box; `axes` has the titles `x`, `y` (and `y2`), and the `range` of x if it is not all of it. */
export async function draw(node, traces, axes) {
  const plotly = await load();
  if (!drawn.has(node)) fit.observe(node);
  drawn.set(node, { traces, axes });
  const colours = palette();
  const coloured = traces.map((trace, index) => withColour(trace, colours.lines[index % colours.lines.length]));
  await plotly.react(node, coloured, layoutOf(axes, colours, node), CONFIG);
  node.setAttribute("role", "img");
  node.setAttribute("aria-label", `Plot: ${axes.title ?? axes.y} over ${axes.x}`);
  return node;
}

/** Calls `zoomed` with [from, to] when the user changes the range of x, and with null when it is set free. */
export function onZoom(node, zoomed) {
  node.removeAllListeners?.("plotly_relayout");
  node.on("plotly_relayout", (change) => {
    const range = change["xaxis.range"] ?? [change["xaxis.range[0]"], change["xaxis.range[1]"]];
    if (range[0] !== undefined && range[1] !== undefined) zoomed(range.map(Number));
    else if (change["xaxis.autorange"]) zoomed(null);
  });
}

function withColour(trace, colour) {
  if (trace.type === "heatmap") return trace;
  if (trace.error_y) return { ...trace, marker: { ...trace.marker, color: colour }, error_y: { ...trace.error_y, color: colour } };
  return { ...trace, line: { ...trace.line, color: colour }, marker: { ...trace.marker, color: colour } };
}

function layoutOf({ x, y, y2, range, title, fromZero }, colours, node) {
  const axis = (text) => ({
    title: { text, standoff: 8 }, gridcolor: colours.grid, zerolinecolor: colours.grid, linecolor: colours.grid, automargin: true, exponentformat: "power", separatethousands: true,
  });
  const layout = {
    autosize: true,
    height: node.clientHeight || 320,
    margin: { l: 56, r: 16, t: title ? 36 : 16, b: 44 },
    paper_bgcolor: "rgba(0,0,0,0)",
    plot_bgcolor: "rgba(0,0,0,0)",
    font: { color: colours.text, family: "system-ui, sans-serif", size: 12 },
    xaxis: { ...axis(x), exponentformat: "none" },
    yaxis: axis(y),
    legend: { orientation: "h", y: 1.02, yanchor: "bottom", x: 0 },
    separators: ".\u202f",
    hovermode: "closest",
    modebar: { bgcolor: "rgba(0,0,0,0)", color: colours.muted, activecolor: colours.text },
  };
  if (title) layout.title = { text: title, font: { size: 13 } };
  if (range) layout.xaxis.range = range;
  if (fromZero) {
    layout.xaxis.rangemode = "tozero";
    layout.yaxis.rangemode = "tozero";
  }
  if (y2) layout.yaxis2 = { ...axis(y2), overlaying: "y", side: "right", showgrid: false };
  return layout;
}

function palette() {
  const style = getComputedStyle(document.documentElement);
  const value = (name) => style.getPropertyValue(name).trim();
  return { text: value("--text"), muted: value("--muted"), grid: value("--line"), lines: ["--plot-1", "--plot-2", "--plot-3", "--plot-4"].map(value) };
}

window.matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => {
  for (const [node, { traces, axes }] of drawn) draw(node, traces, axes);
});
