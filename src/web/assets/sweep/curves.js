// A quantity over the first axis: both branches and halves, jumps, ranges with two motions, and the kinds of motion
// below.

import { CONTACTS, FAILED, REGIMES, kindOf } from "./quantities.js";
import { resonancesOf } from "./resonances.js";
import { hover, lookOf, markOf, nameOf, steps } from "./style.js";
import { thinned, windowOf } from "./thin.js";

/** Lines with more points than this show no mark at each. */
const MARKED = 150;
/** Jumps that are drawn; more would hide the curves. */
const JUMPS = 60;
/** Curves that differ by less than this part are one to the eye. */
const ALIKE = 2e-3;
/** Columns of the strip. */
const STRIP = 1500;

/** @param {SweepState} sweep @param {SweepView} view @returns {Plot} */
export function curves(sweep, view) {
  const { grid, quantity } = view;
  const axis = grid.axes[0];
  const x = grid.order.map((first) => axis.values[first]);
  const [from, to] = windowOf(x, view.range);
  const sides = sidesOf(sweep, view);
  const traces = [];
  grid.branches.forEach((branch, b) => {
    const positions = grid.order.map((first) => grid.at(first, view.line, b));
    for (const side of sides) {
      const column = columnOf(sweep, quantity, side);
      const y = Float64Array.from(positions, (position) => column[position]);
      traces.push(...curve({ x, y, positions, from, to, branch, side, axis, quantity }));
    }
  });
  traces.push(...jumpsOf(sweep, view, x, sides[0]), ...rangeKey(sweep, view), ...selectedOf(sweep, view, sides));
  const rows = strip(sweep, view, x, from, to);
  traces.push(...rows.traces);
  const resonances = view.resonances ? resonancesOf(sweep.rest, view, [x[0], x[x.length - 1]]) : [];
  return {
    traces,
    axes: {
      x: axis.title,
      y: { label: quantity.label, unit: quantity.unit },
      yPart: 0.85 - footOf(grid),
      name: quantity.label,
      hover: "closest",
      click: view.click,
      keys: keysOf(sweep, view),
      csvName: `${sweep.name} ${quantity.label}`,
      more: (layout, colour, { width }) => arrange(layout, colour, width, { sweep, view, rows, resonances, axis, x }),
    },
  };
}

/**
 * The curves of a branch: that of the pair, of one half, of both, or one for both where they would cover each other.
 * @typedef {"both" | "alike" | "left" | "right"} Side
 * @param {SweepState} sweep
 * @param {SweepView} view
 * @returns {Side[]}
 */
function sidesOf(sweep, { grid, line, quantity, halves }) {
  if (quantity.columns.both) return ["both"];
  if (halves !== "both") return [halves];
  const [left, right] = /** @type {Side[]} */ (["left", "right"]).map((side) => columnOf(sweep, quantity, side));
  /** @param {number} position */
  const alike = (position) => !(Math.abs(left[position] - right[position]) > ALIKE * Math.abs(left[position]));
  const all = grid.branches.every((_, b) => grid.order.every((first) => alike(grid.at(first, line, b))));
  return all ? ["alike"] : ["left", "right"];
}

/** @param {SweepState} sweep @param {SweepQuantity} quantity @param {Side} side */
const columnOf = (sweep, quantity, side) => sweep.data.column(quantity.columns[side === "alike" ? "left" : side] ?? "");

function curve({ x, y, positions, from, to, branch, side, axis, quantity }) {
  const { colour, dash } = lookOf(branch, side);
  const kept = thinned(y, from, to);
  const name = nameOf(branch, side);
  const values = kept.map((at) => (Number.isNaN(y[at]) ? null : y[at]));
  const solved = kept.filter((at) => !Number.isNaN(y[at]));
  // A point between two gaps would not show as a line.
  const marked = kept.length <= MARKED || solved.length < kept.length / 2;
  const main = {
    type: "scatter", mode: marked ? "lines+markers" : "lines", name, x: kept.map((at) => x[at]), y: values, customdata: kept.map((at) => positions[at]),
    hovertemplate: `${hover("", axis.unit, "x")}<br>${hover("", quantity.unit, "y")}<extra>${name}</extra>`, showlegend: Boolean(name), connectgaps: false,
    paint: (of) => ({ line: { color: of(colour), width: 1.8, dash }, marker: { color: of(colour), size: 5 } }),
  };
  if (!branch || side === "right") return [main];
  // Marks that point the way the branch was followed; those of the other branch stand between them.
  const shift = branch === "down" ? 0.5 : 0;
  const places = [1, 2, 3, 4, 5, 6].map((part) => solved[Math.floor(((part - shift) * solved.length) / 7)]);
  const shown = solved.length > 7 ? [...new Set(places)] : [];
  const arrows = {
    type: "scatter", mode: "markers", x: shown.map((at) => x[at]), y: shown.map((at) => y[at]), hoverinfo: "skip", showlegend: false, aside: true,
    paint: (of) => ({ marker: { color: of(colour), size: 11, symbol: markOf(branch) } }),
  };
  return [main, arrows];
}

/** The jumps of the line that is shown. @param {SweepState} sweep @param {SweepView} view */
export function jumpsAt(sweep, view) {
  const value = view.grid.axes[1]?.values[view.line] ?? null;
  return (sweep.rest?.sweep?.jumps ?? []).filter((jump) => jump.second_axis_value === value);
}

/** The ranges with two motions of the line that is shown. @param {SweepState} sweep @param {SweepView} view */
export function hysteresisAt(sweep, view) {
  const value = view.grid.axes[1]?.values[view.line] ?? null;
  return (sweep.rest?.sweep?.hysteresis ?? []).filter((range) => range.second_axis_value === value);
}

/**
 * Arrows from the point before to the point after each jump, one trace for each branch.
 * @param {SweepState} sweep
 * @param {SweepView} view
 * @param {number[]} x
 * @param {Side} side
 * @returns {Trace[]}
 */
function jumpsOf(sweep, view, x, side) {
  const { grid, quantity } = view;
  const column = columnOf(sweep, quantity, side);
  const place = new Map(x.map((value, index) => [value, grid.order[index]]));
  return grid.branches.flatMap((branch, b) => {
    const jumps = jumpsAt(sweep, view).filter((jump) => jump.branch === branch).slice(0, JUMPS);
    if (!jumps.length) return [];
    const ends = jumps.map((jump) => [jump.from, jump.to].map((value) => ({ value, position: grid.at(place.get(value) ?? 0, view.line, b) })));
    const { colour } = lookOf(branch, side);
    return [{
      type: "scatter", mode: "lines+markers", name: `jump ${branch}`, aside: true, showlegend: true,
      x: ends.flatMap(([before, after]) => [before.value, after.value, null]),
      y: ends.flatMap(([before, after]) => [column[before.position], column[after.position], null]),
      customdata: ends.flatMap(([before, after]) => [before.position, after.position, null]),
      hovertemplate: `jump on the way ${branch}<br>${hover("", grid.axes[0].unit, "x")}<br>${hover("", quantity.unit, "y")}<extra></extra>`,
      paint: (of) => ({
        line: { color: of(colour), width: 3 },
        marker: { color: of("--text"), size: ends.flatMap(() => [0, 13, 0]), symbol: "arrow", angleref: "previous", standoff: 1 },
      }),
    }];
  });
}

/**
 * The meaning of the shaded ranges, for the legend.
 * @param {SweepState} sweep
 * @param {SweepView} view
 * @returns {Trace[]}
 */
function rangeKey(sweep, view) {
  if (!hysteresisAt(sweep, view).length) return [];
  return [{
    type: "scatter", mode: "markers", name: "two motions", x: [null], y: [null], aside: true, showlegend: true, hoverinfo: "skip",
    paint: (of) => ({ marker: { symbol: "square", size: 13, color: of("--accent"), opacity: 0.3 } }),
  }];
}

/** @param {SweepState} sweep @param {SweepView} view @param {Side[]} sides @returns {Trace[]} */
function selectedOf(sweep, view, sides) {
  const { grid, quantity, selected } = view;
  if (selected === null) return [];
  const place = grid.placeOf(selected);
  if (place.second !== view.line) return [];
  const at = grid.axes[0].values[place.first];
  return [{
    type: "scatter", mode: "markers", x: sides.map(() => at), y: sides.map((side) => columnOf(sweep, quantity, side)[selected]), hoverinfo: "skip", showlegend: false, aside: true,
    paint: (of) => ({ marker: { size: 15, symbol: "circle-open", color: of("--text"), line: { width: 2.5, color: of("--text") } } }),
  }];
}

/**
 * The kinds of motion and contact of each point, and points without a response, as rows of coloured cells.
 * @param {SweepState} sweep
 * @param {SweepView} view
 * @param {number[]} x
 * @param {number} from
 * @param {number} to
 */
function strip(sweep, view, x, from, to) {
  const { grid } = view;
  const [regime, contact, error] = ["regime", "contact", "error"].map((name) => sweep.data.column(name));
  const step = Math.max(1, Math.ceil((to - from) / STRIP));
  /** @type {number[]} */
  const places = [];
  for (let at = from; at < to; at += step) places.push(at);
  const columns = places.map((at) => x[at]);
  // Of the points in a cell the least regular kind of motion.
  /** @param {PointKind[]} kinds @param {any} words @param {number} b */
  const row = (kinds, words, b) => places.map((at) => {
    let worst = null;
    for (let i = at; i < Math.min(to, at + step); i += 1) {
      const position = grid.at(grid.order[i], view.line, b);
      const kind = kindOf(kinds, words[position], error[position]);
      if (kind !== null && (worst === null || kind > worst)) worst = kind;
    }
    return worst;
  });
  /** @type {string[]} */
  const labels = [];
  /** @type {Record<string, string>} */
  const arrows = { up: "↑", down: "↓" };
  /** @param {string} what @param {string} branch */
  const label = (what, branch) => [what, arrows[branch]].filter(Boolean).join(" ");
  /** @param {string} what @param {PointKind[]} kinds @param {any} words @returns {Trace} */
  const heat = (what, kinds, words) => {
    const all = [...kinds, FAILED];
    const z = grid.branches.map((_, b) => row(kinds, words, b)).reverse();
    // Rows by number, the lowest first; their labels are those of the axis.
    const y = grid.branches.map((branch) => label(what, branch)).reverse().map((text) => labels.push(text) - 1);
    const positions = grid.branches.map((_, b) => places.map((at) => grid.at(grid.order[at], view.line, b))).reverse();
    return {
      type: "heatmap", aside: true, x: columns, y, z, customdata: positions, yaxis: "y2", showscale: false, zmin: 0, zmax: all.length, ygap: 2,
      text: z.map((kindsOfRow) => kindsOfRow.map((kind) => (kind === null ? "not solved yet" : all[kind].label))), hoverongaps: false,
      hovertemplate: `${hover("", grid.axes[0].unit, "x")}<br>%{text}<extra>${what}</extra>`,
      paint: (of) => ({ colorscale: steps(all.map(({ colour }) => of(colour))) }),
    };
  };
  return { traces: [heat("contact", CONTACTS, contact), heat("motion", REGIMES, regime)], labels };
}

/**
 * The kinds of motion and contact that occur, with their colours.
 * @param {SweepState} sweep
 * @param {SweepView} view
 * @returns {PlotKey[]}
 */
function keysOf(sweep, { grid, line }) {
  const [regime, contact, error] = ["regime", "contact", "error"].map((name) => sweep.data.column(name));
  const positions = grid.branches.flatMap((_, b) => grid.order.map((first) => grid.at(first, line, b)));
  /** @param {PointKind[]} kinds @param {any} words @param {string} what */
  const seen = (kinds, words, what) => {
    const found = new Set(positions.map((position) => kindOf(kinds, words[position], error[position])));
    return [...kinds, FAILED].filter((_, index) => found.has(index)).map(({ label, colour }) => ({ label: `${what}: ${label}`, colour }));
  };
  return [...seen(REGIMES, regime, "motion"), ...seen(CONTACTS, contact, "contact").filter(({ label }) => !label.endsWith(FAILED.label))];
}

/** Part of the height that the strip takes. @param {SweepView["grid"]} grid */
const footOf = (grid) => 0.05 + 0.045 * 2 * grid.branches.length;

/** Room of a label along a line, px. */
const LABEL_PX = 15;

function arrange(layout, colour, width, { sweep, view, rows, resonances, axis, x }) {
  const foot = footOf(view.grid);
  layout.yaxis = { ...layout.yaxis, domain: [foot + 0.04, 1], type: view.log ? "log" : "linear", rangemode: view.log ? "normal" : "tozero", ...(view.log ? { exponentformat: "power", dtick: "D2" } : {}) };
  layout.yaxis2 = { domain: [0, foot - 0.03], range: [-0.5, rows.labels.length - 0.5], anchor: "x", fixedrange: true, showgrid: false, zeroline: false, automargin: true, tickfont: { size: 11 }, tickvals: [...rows.labels.keys()], ticktext: rows.labels };
  layout.xaxis = { ...layout.xaxis, anchor: "y2", type: axis.logarithmic ? "log" : "linear" };
  const range = view.range ?? edges(x, axis.logarithmic);
  layout.xaxis.range = axis.logarithmic ? range.map(Math.log10) : range;
  const across = { type: "rect", xref: "x", yref: "y domain", y0: 0, y1: 1, line: { width: 0 }, layer: "below" };
  const ranges = hysteresisAt(sweep, view);
  layout.shapes = [
    ...ranges.map(({ from, to }) => ({ ...across, ...widened(from, to, x), fillcolor: colour("--accent"), opacity: 0.13 })),
    ...jumpsAt(sweep, view).slice(0, JUMPS).map(({ from, to }) => ({ ...across, x0: from, x1: to, fillcolor: colour("--warn"), opacity: 0.3 })),
    ...resonances.map(({ at }) => ({ type: "line", xref: "x", yref: "y domain", x0: at, x1: at, y0: 0, y1: 1, line: { color: colour("--muted"), width: 1, dash: "dot" }, layer: "below" })),
  ];
  const along = (value) => (axis.logarithmic ? Math.log10(value) : value);
  // Labels with room beside the one before.
  const apart = (LABEL_PX * (along(range[1]) - along(range[0]))) / Math.max(100, width - 100);
  /** @type {number[]} */
  const labelled = [];
  const named = resonances.filter(({ at, label }) => {
    const hasRoom = label && labelled.every((other) => Math.abs(along(at) - other) > apart);
    if (hasRoom) labelled.push(along(at));
    return hasRoom;
  });
  layout.annotations =
    named.map(({ at, label }) => ({ x: along(at), yref: "y domain", y: 0.98, yanchor: "top", xanchor: "right", textangle: -90, showarrow: false, text: label, font: { size: 10, color: colour("--muted") } }));
  layout.margin = { ...layout.margin, l: 70 };
}

/**
 * From half a step before the first value to half a step after the last.
 * @param {number[]} x
 * @param {boolean} logarithmic
 */
function edges(x, logarithmic) {
  const [first, last, before] = [x[0], x[x.length - 1], x[x.length - 2]];
  if (first === last) return [first - 0.5 * Math.abs(first || 1), first + 0.5 * Math.abs(first || 1)];
  if (logarithmic) return [first * Math.sqrt(first / x[1]), last * Math.sqrt(last / before)];
  return [first - (x[1] - first) / 2, last + (last - before) / 2];
}

/**
 * A range of points with half a step at each end, so that a single point has a width.
 * @param {number} from
 * @param {number} to
 * @param {number[]} x
 */
function widened(from, to, x) {
  const last = x[x.length - 1];
  const half = x.length > 1 ? Math.abs(last - x[0]) / (x.length - 1) / 2 : 0;
  return { x0: Math.max(x[0], from - half), x1: Math.min(last, to + half) };
}
