// The table of a sweep, a page at a time from the server.

import * as api from "../common/api.js";
import { decimal } from "../common/csv.js";
import { byAnyId, byId, download, el, notify, show } from "../common/dom.js";
import { number } from "../common/format.js";

const ROWS = 50;

export class PointTable {
  /** @param {SweepState} sweep @param {SweepView["grid"]} grid @param {(position: number) => void} select */
  constructor(sweep, grid, select) {
    this.sweep = sweep;
    this.grid = grid;
    this.select = select;
    this.from = 0;
    this.failedOnly = false;
    /** @type {number | null} */
    this.selected = null;
    this.asked = 0;
    this.details = byId("sweep-details");
    this.table = byId("sweep-table");
    this.table.tHead?.replaceChildren(this.head());
    this.details.addEventListener("toggle", () => this.update());
    /** @param {() => number} to */
    const step = (to) => () => { this.from = Math.min(Math.max(0, to()), this.lastStart()); this.update(); };
    byId("sweep-first").addEventListener("click", step(() => 0));
    byId("sweep-back").addEventListener("click", step(() => this.from - ROWS));
    byId("sweep-next").addEventListener("click", step(() => this.from + ROWS));
    byId("sweep-last").addEventListener("click", step(() => this.lastStart()));
    byId("sweep-failed").addEventListener("change", () => { this.failedOnly = byId("sweep-failed").checked; this.from = 0; this.update(); });
    byId("sweep-csv").addEventListener("click", () => this.save());
  }

  head() {
    const names = [
      ...this.grid.axes.map(({ title }) => title), ...(this.grid.branches[0] ? ["Branch"] : []),
      ...this.sweep.quantities.flatMap(({ label, unit, columns }) => Object.keys(columns).map((side) => [label, side === "both" ? "" : side, unit].filter(Boolean).join(", "))),
      "Motion", "Contact", "Why there is no response",
    ];
    return el("tr", {}, ...names.map((name) => el("th", { scope: "col" }, name)));
  }

  count() {
    return this.failedOnly ? this.sweep.data.failed().length : this.grid.total;
  }

  lastStart() {
    return Math.max(0, Math.floor((this.count() - 1) / ROWS) * ROWS);
  }

  /** Turns to the page with the selected point. @param {number} position */
  turnTo(position) {
    this.selected = position;
    if (!this.details.open) return;
    if (!this.failedOnly) this.from = Math.floor(position / ROWS) * ROWS;
    this.update();
  }

  async update() {
    const failed = this.sweep.data.failed();
    show(/** @type {HTMLElement} */ (byId("sweep-failed").parentElement), failed.length > 0);
    if (!this.details.open) return;
    this.asked += 1;
    const asked = this.asked;
    try {
      const rows = this.failedOnly ? await this.failedRows(failed) : await this.page();
      if (asked === this.asked) this.fill(rows);
    } catch (error) {
      notify(byId("notice"), error);
    }
  }

  /**
   * @typedef {{ position: number, value: (name: string) => any }} TableRow
   * @returns {Promise<TableRow[]>}
   */
  async page() {
    const to = Math.min(this.grid.total, this.from + ROWS);
    const { positions, columns } = await api.pointColumns(this.sweep.id, { from: this.from, to, limit: ROWS });
    const rows = new Map(positions.map((position, index) => [position, index]));
    return Array.from({ length: to - this.from }, (_, index) => {
      const position = this.from + index;
      const row = rows.get(position);
      return { position, value: (name) => (row === undefined ? undefined : columns[name][row]) };
    });
  }

  /** @param {number[]} failed positions @returns {Promise<TableRow[]>} */
  async failedRows(failed) {
    const errors = this.sweep.data.column("error");
    return failed.slice(this.from, this.from + ROWS).map((position) => ({ position, value: (name) => (name === "error" ? errors[position] : null) }));
  }

  /** @param {TableRow[]} rows */
  fill(rows) {
    const nodes = rows.map(({ position, value }) => {
      const [head, ...others] = this.grid.valuesAt(position).map((at) => number(at, 7));
      const button = el("button", { type: "button", class: "quiet" }, head);
      button.setAttribute("aria-label", `Show the point at ${this.grid.describe(position)}`);
      button.addEventListener("click", () => this.select(position));
      const branch = this.grid.branches[this.grid.placeOf(position).branch];
      const solved = value("error") !== undefined;
      const cells = [
        ...others, ...(branch ? [branch] : []),
        ...this.sweep.quantities.flatMap(({ columns }) => Object.values(columns).map((name) => number(value(name)))),
        value("regime") ?? (solved ? "–" : "not solved yet"), value("contact") ?? "–", value("error") ?? "",
      ];
      const row = el("tr", { class: position === this.selected ? "selected" : "" }, el("th", { scope: "row" }, button), ...cells.map((cell) => el("td", {}, cell)));
      if (position === this.selected) row.setAttribute("aria-current", "true");
      return row;
    });
    this.table.tBodies[0].replaceChildren(...nodes);
    const count = this.count();
    byId("sweep-page").textContent = count ? `Rows ${number(this.from + 1)} to ${number(Math.min(count, this.from + ROWS))} of ${number(count)}` : "No rows";
    for (const [id, off] of [["sweep-first", this.from === 0], ["sweep-back", this.from === 0], ["sweep-next", this.from >= this.lastStart()], ["sweep-last", this.from >= this.lastStart()]]) byAnyId(String(id)).disabled = off;
  }

  async save() {
    const button = byId("sweep-csv");
    button.disabled = true;
    try {
      download(`sweep-${this.sweep.id}.csv`, await api.pointsCsv(this.sweep.id, decimal()), "text/csv");
    } catch (error) {
      notify(byId("notice"), error);
    }
    button.disabled = false;
  }
}
