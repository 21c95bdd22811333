// Style of plots: colours of the stylesheet, layout, hover texts.

import { el } from "./dom.js";
import { shownUnit } from "./format.js";

/** Width below which a plot has the layout for telephones, px. */
const NARROW = 480;
const DASHES = ["solid", "dash", "dot", "dashdot", "longdash"];
const UNITS = ["N/µm", "N/mm", "kg·m²", "m/s²", "m/s", "µm", "mm", "m", "N", "N·m", "MPa", "Hz", "s", "ms", "%", "°", "rad", "rad/s", "rad/s²", "r/min", "dB", "W", "kg"];

/** An element in the colours of paper. @type {HTMLElement | null} */
let paperElement = null;

function onPaper() {
  if (!paperElement) {
    paperElement = el("div", { class: "paper", hidden: true });
    document.body.append(paperElement);
  }
  return paperElement;
}

/** Colours of the page, or those of paper. @param {boolean} [paper] */
export function palette(paper = false) {
  const style = getComputedStyle(paper ? onPaper() : document.documentElement);
  /** Any colour of the stylesheets by its name. @param {string} name */
  const of = (name) => style.getPropertyValue(name).trim();
  const lines = ["--plot-1", "--plot-2", "--plot-3", "--plot-4", "--plot-5", "--plot-6"].map(of).filter(Boolean);
  return { of, text: of("--text"), muted: of("--muted"), grid: of("--line"), surface: of("--surface"), lines };
}

/** Label and unit of an axis given as text: "Time, s", a bare unit, a bare label; or { label, unit }. */
export function parts(axis) {
  if (!axis) return { label: "", unit: "" };
  if (typeof axis === "object") return { label: axis.label ?? "", unit: shownUnit(axis.unit) };
  if (UNITS.includes(axis)) return { label: "", unit: axis };
  const comma = axis.lastIndexOf(", ");
  const unit = axis.slice(comma + 2);
  return comma > 0 && (UNITS.includes(unit) || unit.length <= 8) ? { label: axis.slice(0, comma), unit } : { label: axis, unit: "" };
}

const titleOf = (axis) => {
  const { label, unit } = parts(axis);
  return [label, unit].filter(Boolean).join(", ");
};

/**
 * The traces in the page's colours and dashes, with hover texts; bands first, so that lines lie above them.
 * @param {Trace[]} traces
 * @param {PlotAxes} axes
 * @param {ReturnType<typeof palette>} colours
 * @param {{ width?: number, height?: number }} [size]
 */
export function styled(traces, axes, colours, { width = 900, height = 320 } = {}) {
  const unified = hoverMode(traces, axes) === "x unified";
  let place = 0;
  const drawn = withoutOverlaps(traces, axes, width, height).map((trace) => {
    const at = trace.colour ?? (trace.tone === "muted" ? 0 : place++);
    const colour = trace.tone === "muted" ? colours.muted : colours.lines[at % colours.lines.length];
    const { tone, colour: own, aside, unit, paint, ...rest } = trace;
    if (paint) return { ...rest, ...paint(colours.of), ...(rest.colorbar ? { colorbar: { ...rest.colorbar, tickfont: { color: colours.text } } } : {}) };
    return { ...inColour(rest, colour, DASHES[at % DASHES.length], colours, axes.equal && width < NARROW), hovertemplate: trace.hovertemplate ?? hoverText(trace, axes, unified) };
  });
  // An axis is only drawn with a trace on it.
  const above = axes.top ? [{ type: "scatter", mode: "markers", x: [null], y: [null], xaxis: "x2", showlegend: false, hoverinfo: "skip" }] : [];
  return [...(axes.bands ?? []).flatMap((band, index) => filled(band, colours.lines[(band.colour ?? index) % colours.lines.length])), ...drawn, ...above];
}

/** Room of a label beside points, px. */
const LABEL = { width: 15, height: 13 };

/**
 * The traces with the labels of points that have room; of those too near to each other the upper one keeps its own.
 * Only where the ends of both axes are known.
 * @param {Trace[]} traces
 * @param {PlotAxes} axes
 * @param {number} width
 * @param {number} height
 */
function withoutOverlaps(traces, { range, yRange }, width, height) {
  if (!range || !yRange) return traces;
  const [across, up] = [(width - 90) / (range[1] - range[0]), (height - 90) / (yRange[1] - yRange[0])];
  /** @param {Trace} trace */
  const isLabelled = ({ mode, text }) => mode?.includes("text") && Array.isArray(text);
  const labels = traces.flatMap((trace, at) => (isLabelled(trace) ? trace.x.map((/** @type {number} */ x, /** @type {number} */ index) => ({ at, index, x: x * across, y: trace.y[index] * up, text: trace.text[index] })) : []));
  /** @type {typeof labels} */
  const kept = [];
  for (const label of labels.sort((a, b) => b.y - a.y)) {
    const near = kept.find(({ x, y }) => Math.abs(x - label.x) <= LABEL.width && Math.abs(y - label.y) <= LABEL.height);
    if (!near) kept.push(label);
    // Two points at one place share a label.
    else if (Math.abs(near.x - label.x) < LABEL.width / 3 && !near.text.includes(",")) near.text = `${near.text}, ${label.text}`;
  }
  /** @param {number} at @param {number} index */
  const textAt = (at, index) => kept.find((label) => label.at === at && label.index === index)?.text ?? "";
  return traces.map((trace, at) => (isLabelled(trace) ? { ...trace, text: trace.text.map((/** @type {string} */ _, /** @type {number} */ index) => textAt(at, index)) } : trace));
}

/**
 * The marks with their labels in rows, so that none covers the one before.
 * @param {NonNullable<PlotAxes["marks"]>} marks
 * @param {Trace[]} traces
 * @param {number[] | undefined} range
 * @param {{ width: number, height: number }} size
 */
function inRows(marks, traces, range, { width, height }) {
  const places = traces.flatMap(({ x = [] }) => [...x]).filter((x) => typeof x === "number");
  const [low, high] = range ?? [places.reduce((a, b) => Math.min(a, b), Infinity), places.reduce((a, b) => Math.max(a, b), -Infinity)];
  const scale = (width - 90) / (high - low);
  if (!(scale > 0) || !Number.isFinite(scale)) return marks;
  const row = 13 / Math.max(60, height - 100);
  /** Ends of the labels by row, px. @type {Map<number, number>} */
  const ends = new Map();
  /** @type {Map<typeof marks[number], number>} */
  const rows = new Map();
  for (const mark of marks.filter(({ text }) => text).sort((a, b) => a.x - b.x)) {
    const start = mark.x * scale;
    let at = mark.at ?? 1;
    while ((ends.get(Math.round(100 * at)) ?? -Infinity) > start && at > row) at -= row;
    ends.set(Math.round(100 * at), start + 6.5 * (mark.text ?? "").length);
    rows.set(mark, at);
  }
  return marks.map((mark) => (rows.has(mark) ? { ...mark, at: rows.get(mark) } : mark));
}

function filled({ x, low, high, name = "" }, colour) {
  const edge = { type: "scatter", mode: "lines", x, line: { width: 0, color: colour }, hoverinfo: "skip", showlegend: false };
  return [{ ...edge, y: low }, { ...edge, y: high, name, showlegend: Boolean(name), fill: "tonexty", ...fillOf(colour) }];
}

/** A colour of the stylesheet ("rgb(0, 103, 165)"), seen through. */
const fillOf = (colour) => ({ fillcolor: colour.replace("rgb(", "rgba(").replace(")", ", .22)") });

function inColour(trace, colour, dash, colours, below) {
  if (trace.type === "heatmap") {
    // A plot true to scale needs the whole width.
    const place = below ? { orientation: "h", x: 0.5, y: -0.55, yanchor: "top", thickness: 10, title: { ...trace.colorbar.title, side: "top" } } : {};
    return { ...trace, colorbar: { ...trace.colorbar, ...place, tickfont: { color: colours.text } } };
  }
  if (trace.type === "bar") return { ...trace, marker: { color: colour, ...trace.marker } };
  if (trace.error_y) return { ...trace, marker: { ...trace.marker, color: colour }, error_y: { ...trace.error_y, color: colour } };
  return { ...trace, line: { dash, color: colour, ...trace.line }, marker: { color: colour, ...trace.marker } };
}

function hoverText(trace, axes, unified) {
  const [x, y] = [parts(axes.x), parts(trace.yaxis === "y2" ? axes.y2 : axes.y)];
  const at = typeof trace.x?.[0] === "string" ? "%{x}" : "%{x:.5~g}";
  const value = typeof trace.y?.[0] === "string" ? "%{y}" : "%{y:.5~g}";
  const with_ = (text, unit) => (unit ? `${text} ${unit}` : text);
  const lines = [x.label ? `${x.label}: ${with_(at, x.unit)}` : with_(at, x.unit), y.label && trace.type === "heatmap" ? `${y.label}: ${with_(value, y.unit)}` : with_(value, y.unit)];
  if (trace.type === "heatmap") return `${lines.join("<br>")}<br><b>${with_("%{z:.5~g}", trace.unit)}</b><extra></extra>`;
  return `${unified ? lines[1] : lines.join("<br>")}<extra>${trace.name ?? ""}</extra>`;
}

/** All values at one place where several curves have the same direction; else those of the nearest point. */
function hoverMode(traces, axes) {
  if (axes.hover) return axes.hover;
  const curves = traces.filter((trace) => !trace.aside);
  const rising = ({ type, mode, x = [] }) => type === "scatter" && mode === "lines" && x.every((value, index) => index === 0 || value >= x[index - 1]);
  return curves.length > 1 && curves.every(rising) ? "x unified" : "closest";
}

/** A title in as many lines as its axis is too short for, px. */
function broken(text, room) {
  const most = Math.max(10, Math.floor(room / 6.6));
  const lines = [""];
  for (const word of text.split(" ")) {
    const last = lines[lines.length - 1];
    if (last && last.length + word.length >= most) lines.push(word);
    else lines[lines.length - 1] = [last, word].filter(Boolean).join(" ");
  }
  return lines.join("<br>");
}

/**
 * The layout of a plot for plotly.js.
 * @param {PlotAxes} axes
 * @param {Trace[]} traces
 * @param {ReturnType<typeof palette>} colours
 * @param {{ width: number, height: number }} size
 */
export function layoutOf(axes, traces, colours, { width, height }) {
  const { range, yRange, y2Range, title, fromZero, equal, log, top, zoomX, marks = [], levels = [] } = axes;
  const axis = (text) => ({
    title: { text, standoff: 8 }, gridcolor: colours.grid, zerolinecolor: colours.grid, linecolor: colours.grid, automargin: true, exponentformat: "power", minexponent: 5, separatethousands: true,
  });
  const named = traces.some((trace) => trace.showlegend);
  /** @type {Record<string, any>} */
  const layout = {
    autosize: true,
    height,
    margin: { l: 56, r: 16, t: (title ? 36 + 18 * (title.split("<br>").length - 1) : 14) + (title && named ? 30 : 0) + (top ? 38 : 0) + (top && named ? 20 : 0), b: 44 },
    paper_bgcolor: "rgba(0,0,0,0)",
    plot_bgcolor: "rgba(0,0,0,0)",
    font: { color: colours.text, family: "system-ui, sans-serif", size: width < NARROW ? 11 : 12 },
    xaxis: { ...axis(broken(titleOf(axes.x), width - 90)), exponentformat: "none", hoverformat: ".5~g" },
    yaxis: { ...axis(broken(titleOf(axes.y), (axes.yPart ?? 1) * (height - 110))), type: log ? "log" : undefined },
    legend: { orientation: "h", y: top ? 1 + 46 / Math.max(100, height - 130) : 1.02, yanchor: "bottom", x: 0 },
    showlegend: named,
    separators: ".\u202f",
    hovermode: hoverMode(traces, axes),
    hoverlabel: { bgcolor: colours.surface, bordercolor: colours.grid, font: { color: colours.text }, align: "left" },
    dragmode: "zoom",
    modebar: { bgcolor: "rgba(0,0,0,0)", color: colours.muted, activecolor: colours.text, orientation: "h" },
    shapes: [...marks.map((mark) => markLine(mark, colours)), ...levels.map((level) => levelLine(level, colours)), ...(axes.shapes ?? [])],
    annotations: [...inRows(marks, traces, range, { width, height }).map((mark) => markText(mark, colours)), ...levels.map((level) => levelText(level, colours)), ...(axes.annotations ?? [])].filter(Boolean),
  };
  if (title) layout.title = { text: title, font: { size: 13 }, y: 1 - 10 / height, yref: "container", yanchor: "top", x: 0, xref: "paper", xanchor: "left" };
  if (range) layout.xaxis.range = [...range];
  if (yRange) layout.yaxis.range = [...yRange];
  if (zoomX) layout.yaxis.fixedrange = true;
  if (fromZero) {
    layout.xaxis.rangemode = "tozero";
    if (!log) layout.yaxis.rangemode = "tozero";
  }
  if (equal) {
    layout.yaxis.scaleanchor = "x";
    layout.yaxis.constrain = "domain";
    layout.xaxis.constrain = "domain";
  }
  if (axes.y2) layout.yaxis2 = { ...axis(titleOf(axes.y2)), overlaying: "y", side: "right", showgrid: false, fixedrange: Boolean(zoomX), range: y2Range && [...y2Range] };
  if (top) layout.xaxis2 = { ...axis(titleOf(top.title)), overlaying: "x", side: "top", showgrid: false, fixedrange: true, exponentformat: "none", range: range?.map((end) => end * top.factor) };
  const whole = { ...layout, ...axes.layout };
  axes.more?.(whole, colours.of, { width, height });
  return whole;
}

/** @param {{ x: number, dash?: string, colour?: string }} mark @param {ReturnType<typeof palette>} colours */
function markLine({ x, dash = "dot", colour }, colours) {
  return { type: "line", x0: x, x1: x, y0: 0, y1: 1, yref: "paper", layer: "below", line: { color: colour ?? colours.muted, width: 1, dash } };
}

/** @param {{ x: number, text?: string, at?: number }} mark @param {ReturnType<typeof palette>} colours */
function markText({ x, text, at = 1 }, colours) {
  if (!text) return null;
  return { x, y: at, yref: "paper", yanchor: "top", xanchor: "left", text, showarrow: false, font: { size: 11, color: colours.muted } };
}

/** @param {{ y: number, dash?: string }} level @param {ReturnType<typeof palette>} colours */
function levelLine({ y, dash = "dash" }, colours) {
  return { type: "line", x0: 0, x1: 1, xref: "paper", y0: y, y1: y, layer: "below", line: { color: colours.muted, width: 1, dash } };
}

/** @param {{ y: number, text?: string }} level @param {ReturnType<typeof palette>} colours */
function levelText({ y, text }, colours) {
  if (!text) return null;
  return { x: 1, xref: "paper", xanchor: "right", y, yanchor: "bottom", text, showarrow: false, font: { size: 11, color: colours.muted } };
}
