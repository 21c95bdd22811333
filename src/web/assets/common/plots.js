// Plots with Plotly: loaded on first use, drawn when scrolled near, coloured by the stylesheet.
//
// `draw(node, traces, axes)` draws into a box of class `plot`; traces come from `line`, `points`, `stems`, `bars`,
// `heatMap`; the members of `axes` are those of `PlotAxes` (src/web/types.d.ts).

import { el } from "./dom.js";
import { layoutOf, palette, styled } from "./plot_style.js";
import { axesOfFile, describe, toolsOf } from "./plot_tools.js";

export { bars, heatMap, line, points, stems } from "./plot_traces.js";

const CONFIG = { displaylogo: false, displayModeBar: true, doubleClick: "autosize", modeBarButtonsToRemove: ["select2d", "lasso2d", "autoScale2d", "toImage"] };
/** Width of a plot on paper: of A4, less its margins and what is around the plot, px. */
const PAPER_WIDTH = 640;
/** Whether the page is being printed: plots have the colours and the width of paper. */
let isOnPaper = false;
/** Distance from the window below which a plot is drawn, px. */
const NEAR = 400;
/** The figure of every box: its data, and whether it is drawn. @type {Map<Element, any>} */
const figures = new Map();
/** @type {Promise<any> | null} */
let loading = null;

/** Plots follow the width of their boxes. */
const fit = new ResizeObserver((changes) => {
  for (const { target, contentRect } of changes) {
    const width = /** @type {any} */ (target)._fullLayout?.width;
    if (!isOnPaper && contentRect.width > 0 && width && Math.abs(width - contentRect.width) > 1) window.Plotly.Plots.resize(target);
  }
});

const nearby = new IntersectionObserver(
  (changes) => {
    for (const { target, isIntersecting } of changes) {
      if (!isIntersecting) continue;
      nearby.unobserve(target);
      render(figures.get(target));
    }
  },
  { rootMargin: `${NEAR}px 0px` },
);

/**
 * Plotly writes some style attributes as text, which the content security policy forbids; through the style object
 * they are allowed, so that the policy needs no exception.
 */
function allowStyleAttributes() {
  const { setAttribute } = Element.prototype;
  /** @this {Element & { style?: CSSStyleDeclaration }} @param {string} name @param {string} value */
  Element.prototype.setAttribute = function (name, value) {
    if (name === "style" && this.style) this.style.cssText = value;
    else setAttribute.call(this, name, value);
  };
}

function load() {
  loading ??= new Promise((resolve, reject) => {
    allowStyleAttributes();
    const page = /** @type {HTMLElement} */ (document.querySelector("[data-plotly]"));
    const script = el("script", { src: page.dataset.plotly, async: true });
    script.addEventListener("load", () => resolve(window.Plotly));
    script.addEventListener("error", () => reject(new Error("The plotting script could not be loaded")));
    document.head.append(script);
  });
  return loading;
}

/**
 * Draws traces into a box, at once when it is near the window and otherwise when it comes near. Below the box stand
 * the plot's tools: its data as a table and as files.
 * @param {HTMLElement} node
 * @param {Trace[]} traces
 * @param {PlotAxes} axes
 */
export async function draw(node, traces, axes) {
  let figure = figures.get(node);
  if (!figure) {
    figure = { node, tools: toolsOf(node, () => figure, (format) => picture(figure.traces, axesOfFile(figure), { format })) };
    figures.set(node, figure);
    makeOperable(figure);
  }
  figure.traces = traces;
  figure.axes = axes;
  figure.drawings = (figure.drawings ?? 0) + 1;
  describe(figure);
  if (figure.drawn || isNear(node)) {
    await render(figure);
  } else {
    nearby.observe(node);
    drawWaiting();
  }
  return node;
}

/** Whether a call of `drawWaiting` is due. */
let isDue = false;

/** Draws what waits to be scrolled near, one plot at each pause of the page: paper does not scroll. */
function drawWaiting() {
  if (isDue) return;
  isDue = true;
  whenIdle(async () => {
    isDue = false;
    const waiting = [...figures.values()].find(({ drawn, node }) => !drawn && node.clientWidth > 0);
    if (!waiting) return;
    nearby.unobserve(waiting.node);
    await render(waiting);
    drawWaiting();
  });
}

/** @param {() => void} task */
function whenIdle(task) {
  if (window.requestIdleCallback) window.requestIdleCallback(task, { timeout: 2000 });
  else setTimeout(task, 200);
}

/**
 * Calls `zoomed` with [from, to] when the user changes the range of x, and with null when it is set free.
 * @param {HTMLElement} node
 * @param {(range: Span | null) => void} zoomed
 */
export function onZoom(node, zoomed) {
  const figure = figures.get(node);
  if (figure) figure.zoomed = zoomed;
}

/** Everything as on paper, also what waits to be scrolled near. */
async function toPaper() {
  isOnPaper = true;
  for (const figure of figures.values()) await render(figure);
}

function toScreen() {
  isOnPaper = false;
  recolour();
}

/**
 * The plot as an image, in the colours of paper: `format` `svg` (text) or `png` (base64).
 * @param {Trace[]} traces
 * @param {PlotAxes} axes
 * @param {{ format?: "svg" | "png", width?: number, height?: number }} [options]
 * @returns {Promise<string>}
 */
export async function picture(traces, axes, { format = "svg", width = 900, height = 480 } = {}) {
  const plotly = await load();
  const colours = palette(true);
  const layout = layoutOf(axes, traces, colours, { width, height });
  const data = [...styled(traces, axes, colours, { width, height }), ...(axes.keys ?? []).map((key) => keyTrace(key, colours))];
  if (axes.keys?.length) layout.showlegend = true;
  return plotly.toImage({ data, layout: { ...layout, width, height, paper_bgcolor: "#ffffff" } }, { format, width, height, scale: format === "png" ? 2 : 1, imageDataOnly: true });
}

/**
 * An entry of the legend for a colour that no trace has.
 * @param {PlotKey} key
 * @param {ReturnType<typeof palette>} colours
 */
const keyTrace = ({ label, colour }, colours) => ({
  type: "scatter", mode: "markers", name: label, x: [null], y: [null], showlegend: true, hoverinfo: "skip", marker: { symbol: "square", size: 11, color: colours.of(colour), line: { color: colours.text, width: 1 } },
});

const isNear = (node) => {
  const { top, bottom, width } = node.getBoundingClientRect();
  return width > 0 && top < window.innerHeight + NEAR && bottom > -NEAR;
};

async function render(figure) {
  const plotly = await load();
  const { node, traces, axes } = figure;
  const colours = palette(isOnPaper);
  const size = { width: isOnPaper ? PAPER_WIDTH : node.clientWidth || 600, height: node.clientHeight || 320 };
  // What was zoomed stays zoomed until something else is drawn.
  const layout = { ...layoutOf(axes, traces, colours, size), uirevision: figure.drawings };
  await plotly.react(node, styled(traces, axes, colours, size), isOnPaper ? { ...layout, autosize: false, width: size.width } : layout, CONFIG);
  if (figure.drawn) return;
  figure.drawn = true;
  fit.observe(node);
  node.on("plotly_relayout", (change) => relayed(figure, change));
  node.on("plotly_click", (event) => figure.axes.click?.(event));
}

function relayed(figure, change) {
  const range = change["xaxis.range"] ?? [change["xaxis.range[0]"], change["xaxis.range[1]"]];
  const chosen = range[0] !== undefined && range[1] !== undefined;
  if (!chosen && !change["xaxis.autorange"]) return;
  const wanted = chosen ? range.map(Number) : null;
  const { axes } = figure;
  if (axes.top) {
    const of = wanted ?? figure.node._fullLayout.xaxis.range;
    window.Plotly.relayout(figure.node, { "xaxis2.range": of.map((end) => end * axes.top.factor) });
  }
  if (axes.link && !figure.following) {
    for (const other of figures.values()) if (other !== figure && other.drawn && other.axes.link === axes.link) follow(other, wanted);
  }
  figure.zoomed?.(wanted);
}

/** A linked plot takes another one's range, without passing it on. */
async function follow(figure, range) {
  figure.following = true;
  await window.Plotly.relayout(figure.node, range ? { "xaxis.range": range } : { "xaxis.autorange": true });
  figure.following = false;
}

/** By keyboard: arrows move, plus and minus zoom, 0 shows all. */
function makeOperable(figure) {
  const { node } = figure;
  node.tabIndex = 0;
  node.setAttribute("role", "group");
  node.setAttribute("aria-roledescription", "plot");
  node.setAttribute("aria-keyshortcuts", "ArrowLeft ArrowRight + - 0");
  node.addEventListener("keydown", (event) => {
    const axis = node._fullLayout?.xaxis;
    if (!axis || event.target !== node || event.ctrlKey || event.altKey || event.metaKey) return;
    const [from, to] = axis.range;
    const span = to - from;
    const moves = { ArrowLeft: [from - span / 5, to - span / 5], ArrowRight: [from + span / 5, to + span / 5], "+": [from + span / 4, to - span / 4], "=": [from + span / 4, to - span / 4], "-": [from - span / 2, to + span / 2] };
    const range = moves[event.key];
    if (!range && event.key !== "0") return;
    event.preventDefault();
    window.Plotly.relayout(node, range ? { "xaxis.range": range } : { "xaxis.autorange": true, "yaxis.autorange": true });
  });
}

function recolour() {
  for (const figure of figures.values()) if (figure.drawn) render(figure);
}

window.addEventListener("schemechange", recolour);
new MutationObserver(recolour).observe(document.documentElement, { attributeFilter: ["class"] });
window.addEventListener("beforeprint", toPaper);
window.addEventListener("afterprint", toScreen);

// Pages that link the stylesheet themselves show it sooner.
if (!document.querySelector('link[href="/assets/common/plots.css"]')) document.head.append(el("link", { rel: "stylesheet", href: "/assets/common/plots.css" }));
