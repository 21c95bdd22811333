// Reduction of the points of a plot to those that its pixels can show.

/** Groups of points over the width of a plot; each keeps its first, least, greatest and last point. */
const GROUPS = 700;
/** Lines up to this long are drawn whole. */
const WHOLE = 4 * GROUPS;

/**
 * Indices [from, to) of the points of an ascending `x` in `range` (all without one), with one more at each end.
 * @param {number[]} x
 * @param {number[] | null} range
 * @returns {Span}
 */
export function windowOf(x, range) {
  if (!range) return [0, x.length];
  let from = 0;
  while (from < x.length && x[from] < range[0]) from += 1;
  let to = x.length;
  while (to > from && x[to - 1] > range[1]) to -= 1;
  return [Math.max(0, from - 1), Math.min(x.length, to + 1)];
}

/**
 * Indices of `y` between `from` and `to` that a line needs. A group with gaps keeps one of them.
 * @param {ArrayLike<number>} y
 * @param {number} from
 * @param {number} to
 */
export function thinned(y, from, to) {
  const n = to - from;
  if (n <= WHOLE) return Array.from({ length: n }, (_, index) => from + index);
  /** @type {number[]} */
  const kept = [];
  for (let group = 0; group < GROUPS; group += 1) {
    const start = from + Math.floor((group * n) / GROUPS);
    const end = from + Math.floor(((group + 1) * n) / GROUPS);
    let [least, greatest, gap] = [-1, -1, -1];
    for (let at = start; at < end; at += 1) {
      if (Number.isNaN(y[at])) gap = at;
      else {
        if (least < 0 || y[at] < y[least]) least = at;
        if (greatest < 0 || y[at] > y[greatest]) greatest = at;
      }
    }
    const places = [start, least, greatest, gap, end - 1].filter((at) => at >= 0);
    kept.push(...[...new Set(places)].sort((a, b) => a - b));
  }
  return kept;
}

/**
 * Indices of the points that fall on different cells of a raster.
 * @param {number} count
 * @param {(at: number) => number} x
 * @param {(at: number) => number} y
 * @param {number[]} raster columns and rows
 */
export function rastered(count, x, y, [columns, rows]) {
  let [x0, x1, y0, y1] = [Infinity, -Infinity, Infinity, -Infinity];
  for (let at = 0; at < count; at += 1) {
    x0 = Math.min(x0, x(at));
    x1 = Math.max(x1, x(at));
    y0 = Math.min(y0, y(at));
    y1 = Math.max(y1, y(at));
  }
  const taken = new Uint8Array(columns * rows);
  /** @param {number} value @param {number} from @param {number} to @param {number} cells */
  const cell = (value, from, to, cells) => (to > from ? Math.min(cells - 1, Math.floor(((value - from) / (to - from)) * cells)) : 0);
  /** @type {number[]} */
  const kept = [];
  for (let at = 0; at < count; at += 1) {
    const place = cell(x(at), x0, x1, columns) * rows + cell(y(at), y0, y1, rows);
    if (taken[place]) continue;
    taken[place] = 1;
    kept.push(at);
  }
  return kept;
}
