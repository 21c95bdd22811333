// The rows of a sweep by columns: fetched when they are needed and as they are solved, at most once each.

import * as api from "../common/api.js";
import { SWEEP_COLUMNS } from "../common/quantities.js";

/** Rows per request; fewer when rows contain lists. */
const PAGE = 10_000;
/** The first page is small, so that something shows soon. */
const FIRST_PAGE = 2000;
const PAGE_OF_LISTS = 500;
/** Ranges of missing rows that are fetched one by one; more than these are joined over the rows between them. */
const MOST_GAPS = 8;

/** @param {string} kind */
const namesOf = (kind) => new Set(SWEEP_COLUMNS.filter((column) => column.kind === kind).map(({ name }) => name));
const WORDS = namesOf("word");
const LISTS = namesOf("numbers");

export class SweepData {
  /** @param {string} id @param {number} total number of rows of the complete sweep */
  constructor(id, total) {
    this.id = id;
    this.total = total;
    /** Number of rows that are here. */
    this.n = 0;
    this.here = new Uint8Array(total);
    /** @type {Map<string, any>} */
    this.columns = new Map();
    /** @type {Promise<unknown>} */
    this.last = Promise.resolve();
  }

  /**
   * The values of a column by position: NaN (numbers) or null (words, lists) where there is none.
   * @param {string} name
   * @returns {any}
   */
  column(name) {
    return this.columns.get(name);
  }

  /** @param {string[]} names */
  has(names) {
    return names.every((name) => this.columns.has(name));
  }

  /**
   * Fetches columns for the rows that are here. `onPage` is called at the end.
   * @param {string[]} names
   * @param {() => void} [onPage]
   */
  require(names, onPage) {
    return this.after(async () => {
      const missing = names.filter((name) => !this.columns.has(name));
      if (!missing.length) return;
      const fresh = new Map(missing.map((name) => [name, empty(name, this.total)]));
      if (this.n) await this.fetch([0, this.total], fresh, () => {}, (position) => this.here[position] > 0);
      for (const [name, values] of fresh) this.columns.set(name, values);
      onPage?.();
    });
  }

  /**
   * Fetches the rows solved since the last time, in all columns that are here.
   * @param {() => void} [onPage] called after each page
   */
  refresh(onPage) {
    return this.after(async () => {
      for (const gap of this.gaps()) await this.fetch(gap, this.columns, onPage);
    });
  }

  /** One fetch after the other. @template Value @param {() => Promise<Value>} task @returns {Promise<Value>} */
  after(task) {
    const result = this.last.then(task);
    this.last = result.catch(() => {});
    return result;
  }

  /**
   * Fetches the rows of a range, a page at a time.
   * @param {Span} range
   * @param {Map<string, any>} columns
   * @param {() => void} [onPage]
   * @param {(position: number) => boolean} [wanted]
   */
  async fetch([from, to], columns, onPage, wanted = () => true) {
    const names = [...columns.keys()];
    const limit = names.some((name) => LISTS.has(name)) ? PAGE_OF_LISTS : PAGE;
    /** @type {number | null} */
    let next = from;
    while (next !== null && next < to) {
      const rows = this.n ? limit : Math.min(limit, FIRST_PAGE);
      /** @type {PointColumns} */
      const page = await api.pointColumns(this.id, { names: names.join(), from: next, to, limit: rows });
      page.positions.forEach((position, row) => {
        if (!wanted(position)) return;
        for (const name of names) {
          const value = page.columns[name][row];
          if (value !== null) columns.get(name)[position] = value;
        }
      });
      if (columns === this.columns) {
        for (const position of page.positions) {
          if (!this.here[position]) this.n += 1;
          this.here[position] = 1;
        }
      }
      next = page.next_position ?? null;
      onPage?.();
    }
  }

  /** Ranges [from, to) without rows. @returns {Span[]} */
  gaps() {
    /** @type {Span[]} */
    const gaps = [];
    for (let at = 0; at < this.total; at += 1) {
      if (this.here[at]) continue;
      const last = gaps.at(-1);
      if (last && last[1] === at) last[1] = at + 1;
      else gaps.push([at, at + 1]);
    }
    if (gaps.length <= MOST_GAPS) return gaps;
    // The widest ranges of known rows are left out, the others fetched again.
    const between = gaps.slice(1).map((gap, index) => ({ index, width: gap[0] - gaps[index][1] }));
    const cuts = new Set(between.sort((a, b) => b.width - a.width).slice(0, MOST_GAPS - 1).map(({ index }) => index));
    /** @type {Span[]} */
    const joined = [];
    gaps.forEach(([from, to], index) => {
      if (index === 0 || cuts.has(index - 1)) joined.push([from, to]);
      else joined[joined.length - 1][1] = to;
    });
    return joined;
  }

  /** Positions of the rows that have no response. */
  failed() {
    const errors = this.column("error") ?? [];
    /** @type {number[]} */
    const found = [];
    for (let at = 0; at < this.total; at += 1) if (errors[at]) found.push(at);
    return found;
  }
}

/** @param {string} name @param {number} total */
function empty(name, total) {
  return WORDS.has(name) || LISTS.has(name) ? new Array(total).fill(null) : new Float64Array(total).fill(NaN);
}
