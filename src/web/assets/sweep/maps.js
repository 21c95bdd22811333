// A sweep over two inputs: heat map or contours of a quantity, the kind of motion, and sections along both axes.

import { CONTACTS, FAILED, REGIMES, kindOf } from "./quantities.js";
import { hover, lookOf, nameOf, steps } from "./style.js";

/** @type {{ name: string, label: string, kinds: PointKind[] }[]} */
export const KINDS = [
  { name: "regime", label: "Kind of motion", kinds: REGIMES },
  { name: "contact", label: "Contact of the teeth", kinds: CONTACTS },
];

/**
 * The value of a quantity at a row: of the chosen half, or the greater one.
 * @param {SweepState} sweep
 * @param {SweepQuantity} quantity
 * @param {string} halves
 * @returns {(position: number) => number}
 */
export function valueAt(sweep, quantity, halves) {
  const columns = Object.values(quantity.columns).map((name) => sweep.data.column(name));
  if (columns.length === 1) return (position) => columns[0][position];
  const [left, right] = columns;
  if (halves === "left") return (position) => left[position];
  if (halves === "right") return (position) => right[position];
  return (position) => Math.max(left[position], right[position]);
}

/** @param {SweepState} sweep @param {SweepView} view @returns {Plot} */
export function map(sweep, view) {
  const { grid } = view;
  const [first, second] = grid.axes;
  const x = grid.order.map((index) => first.values[index]);
  const y = grid.secondOrder.map((index) => second.values[index]);
  /** @type {Rows} */
  const rows = (value) => grid.secondOrder.map((line) => grid.order.map((index) => value(grid.at(index, line, view.branch))));
  const positions = rows((position) => position);
  const kinds = KINDS.find(({ name }) => name === view.kind);
  const base = { x, y, customdata: positions, hoverongaps: false };
  const where = `${hover(first.label, first.unit, "x")}<br>${hover(second.label, second.unit, "y")}`;
  /** @type {Trace[]} */
  const traces = [kinds ? kindMap(sweep, kinds, rows, base, where) : valueMap(sweep, view, rows, base, where)];
  const jumps = jumpsOnMap(sweep, view);
  if (jumps.length) {
    traces.push({
      type: "scatter", mode: "markers", name: "jump", aside: true, x: jumps.map(({ x: at }) => at), y: jumps.map(({ y: at }) => at), showlegend: true, hovertemplate: `jump<br>${where}<extra></extra>`,
      paint: (of) => ({ marker: { symbol: "line-ns-open", size: 8, color: of("--text"), line: { width: 2, color: of("--text") } } }),
    });
  }
  const best = kinds || !view.quantity.least ? null : bestOf(sweep, view);
  if (best !== null) traces.push(mark(grid, best, "star", "least", "--plot-2"));
  if (view.selected !== null) traces.push(mark(grid, view.selected, "circle-open", "", "--text"));
  const branch = grid.branches[view.branch];
  const half = kinds || view.quantity.columns.both ? "" : { both: "greater of both halves", left: "left", right: "right" }[view.halves];
  const what = kinds ? kinds.label : [view.quantity.label, view.quantity.unit].filter(Boolean).join(", ");
  return {
    traces,
    axes: {
      x: first.title, y: second.title, title: [what, half, branch].filter(Boolean).join(", "), keys: kinds ? keysOf(sweep, kinds) : undefined, csvName: `${sweep.name} map`, hover: "closest", click: view.click,
      more: (layout) => {
        if (first.logarithmic) layout.xaxis.type = "log";
        if (second.logarithmic) layout.yaxis.type = "log";
      },
    },
  };
}

/**
 * @typedef {<Value>(value: (position: number) => Value) => Value[][]} Rows values by rows of the map
 * @param {SweepState} sweep
 * @param {SweepView} view
 * @param {Rows} rows
 * @param {Trace} base
 * @param {string} where
 * @returns {Trace}
 */
function valueMap(sweep, view, rows, base, where) {
  const value = valueAt(sweep, view.quantity, view.halves);
  /** @param {number} position */
  const shown = (position) => {
    const number = value(position);
    if (Number.isNaN(number)) return null;
    return view.log ? (number > 0 ? Math.log10(number) : null) : number;
  };
  const { unit } = view.quantity;
  const z = rows(shown);
  return {
    ...base, type: view.contours ? "contour" : "heatmap", z, unit: view.log ? `log₁₀ ${unit}` : unit, text: rows(value), colorscale: "Viridis",
    hovertemplate: `${where}<br>${hover("", unit, "text")}<extra></extra>`,
    colorbar: { title: { text: view.log ? `log₁₀ ${unit}` : unit }, thickness: 14, outlinewidth: 0 }, ...(view.contours ? { connectgaps: false, contours: { coloring: "heatmap", showlabels: true } } : {}),
    paint: () => ({}),
  };
}

/**
 * @param {SweepState} sweep
 * @param {typeof KINDS[number]} kind
 * @param {Rows} rows
 * @param {Trace} base
 * @param {string} where
 * @returns {Trace}
 */
function kindMap(sweep, { name, kinds }, rows, base, where) {
  const [words, errors] = [sweep.data.column(name), sweep.data.column("error")];
  const all = [...kinds, FAILED];
  /** @param {number} position */
  const kind = (position) => kindOf(kinds, words[position], errors[position]);
  return {
    ...base, type: "heatmap", z: rows(kind), zmin: 0, zmax: all.length, showscale: false,
    text: rows((position) => words[position] ?? (errors[position] ? FAILED.label : "")), hovertemplate: `${where}<br>%{text}<extra></extra>`,
    paint: (/** @type {(name: string) => string} */ of) => ({ colorscale: steps(all.map(({ colour }) => of(colour))) }),
  };
}

/**
 * The kinds that occur, with their colours.
 * @param {SweepState} sweep
 * @param {typeof KINDS[number]} kind
 * @returns {PlotKey[]}
 */
function keysOf(sweep, { name, kinds }) {
  const errors = sweep.data.column("error");
  const found = new Set(sweep.data.column(name).map((/** @type {string | null} */ word, /** @type {number} */ position) => kindOf(kinds, word, errors[position])));
  return [...kinds, FAILED].filter((_, index) => found.has(index)).map(({ label, colour }) => ({ label, colour }));
}

/**
 * Position of the least value of the branch shown; null without any.
 * @param {SweepState} sweep
 * @param {SweepView} view
 */
function bestOf(sweep, view) {
  const { grid } = view;
  const value = valueAt(sweep, view.quantity, view.halves);
  const from = view.branch * grid.lines * grid.length;
  /** @type {number | null} */
  let best = null;
  for (let position = from; position < from + grid.lines * grid.length; position += 1) {
    if (value(position) < (best === null ? Infinity : value(best))) best = position;
  }
  return best;
}

/**
 * @param {SweepView["grid"]} grid
 * @param {number} position
 * @param {string} symbol
 * @param {string} name
 * @param {string} colour
 * @returns {Trace}
 */
function mark(grid, position, symbol, name, colour) {
  const [x, y] = grid.valuesAt(position);
  return {
    type: "scatter", mode: "markers", x: [x], y: [y], customdata: [position], name, aside: true, showlegend: Boolean(name), hoverinfo: name ? "name" : "skip",
    paint: (of) => ({ marker: { symbol, size: 15, color: of(colour), line: { width: 2, color: of("--surface") } } }),
  };
}

/**
 * The curve through the selected point along one of the two axes.
 * @param {SweepState} sweep
 * @param {SweepView & { selected: number }} view
 * @param {number} along
 * @returns {Plot & { title: string }}
 */
export function section(sweep, view, along) {
  const { grid, quantity } = view;
  const place = grid.placeOf(view.selected);
  const axis = grid.axes[along];
  const order = along === 0 ? grid.order : grid.secondOrder;
  const traces = grid.branches.flatMap((branch, b) => Object.entries(quantity.columns).map(([side, column]) => {
    const positions = order.map((index) => (along === 0 ? grid.at(index, place.second, b) : grid.at(place.first, index, b)));
    const values = sweep.data.column(column);
    const { colour, dash } = lookOf(branch, side);
    const name = nameOf(branch, side);
    return {
      type: "scatter", mode: "lines+markers", name, x: order.map((index) => axis.values[index]), y: positions.map((position) => (Number.isNaN(values[position]) ? null : values[position])), customdata: positions, showlegend: Boolean(name),
      hovertemplate: `${hover("", axis.unit, "x")}<br>${hover("", quantity.unit, "y")}<extra>${name}</extra>`,
      paint: (of) => ({ line: { color: of(colour), width: 1.8, dash }, marker: { color: of(colour), size: 4 } }),
    };
  }));
  const other = grid.axes[1 - along];
  const at = grid.valuesAt(view.selected);
  return {
    traces,
    axes: {
      x: axis.title, y: { label: quantity.label, unit: quantity.unit }, csvName: `${sweep.name} section`, hover: "closest", click: view.click,
      more: (layout, colour) => {
        layout.xaxis.type = axis.logarithmic ? "log" : "linear";
        layout.yaxis.type = view.log ? "log" : "linear";
        layout.shapes = [{ type: "line", xref: "x", yref: "y domain", x0: at[along], x1: at[along], y0: 0, y1: 1, line: { color: colour("--muted"), width: 1, dash: "dot" } }];
      },
    },
    title: `${quantity.label} at ${other.label.toLowerCase()} ${at[1 - along].toPrecision(6).replace(/\.?0+$/, "")} ${other.unit}`,
  };
}

/**
 * Jumps of the branch on the map, each halfway between its points.
 * @param {SweepState} sweep
 * @param {SweepView} view
 */
function jumpsOnMap(sweep, view) {
  const branch = view.grid.branches[view.branch];
  const jumps = (sweep.rest?.sweep?.jumps ?? []).filter((jump) => jump.branch === branch);
  return jumps.map(({ from, to, second_axis_value: y }) => ({ x: (from + to) / 2, y }));
}
