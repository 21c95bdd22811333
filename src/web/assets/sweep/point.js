// One point of a sweep: its values, and the submission of its document as a job of its own.

import * as api from "../common/api.js";
import { byId, el, fillValues, notify, show } from "../common/dom.js";
import { number, sentence } from "../common/format.js";
import { hysteresisAt } from "./curves.js";
import { CONTACTS, QUANTITIES, REGIMES } from "./quantities.js";

/** Longest name that a document may have. */
const NAME_LENGTH = 200;

export class PointPanel {
  /** @param {SweepState} sweep @param {SweepView["grid"]} grid @param {(position: number) => void} select */
  constructor(sweep, grid, select) {
    this.sweep = sweep;
    this.grid = grid;
    this.select = select;
    this.position = 0;
    this.asked = 0;
    byId("sweep-open").addEventListener("click", () => this.open());
    byId("sweep-point-back").addEventListener("click", () => this.step(-1));
    byId("sweep-point-next").addEventListener("click", () => this.step(1));
  }

  /** Selects the neighbour along the first axis. @param {number} by */
  step(by) {
    const { first, second, branch } = this.grid.placeOf(this.position);
    const next = this.grid.order[this.grid.order.indexOf(first) + by];
    if (next !== undefined) this.select(this.grid.at(next, second, branch));
  }

  /** @param {number} position @param {SweepView} view */
  async show(position, view) {
    this.position = position;
    const { first, second, branch } = this.grid.placeOf(position);
    byId("sweep-point-title").textContent = sentence(this.grid.describe(position));
    byId("sweep-point-back").disabled = this.grid.order[0] === first;
    byId("sweep-point-next").disabled = this.grid.order.at(-1) === first;
    byId("sweep-point-note").textContent = this.grid.branches[branch] ? this.noteOf(first, second, view) : "";
    show(byId("sweep-point"));
    this.asked += 1;
    const asked = this.asked;
    try {
      const { positions, columns } = await api.pointColumns(this.sweep.id, { from: position, to: position + 1, limit: 1 });
      if (asked === this.asked) this.fill((name) => (positions.length ? columns[name][0] : undefined));
    } catch (error) {
      notify(byId("notice"), error);
    }
  }

  /** @param {number} first @param {number} second @param {SweepView} view */
  noteOf(first, second, view) {
    const value = this.grid.axes[0].values[first];
    const twofold = hysteresisAt(this.sweep, { ...view, line: second }).some(({ from, to }) => value >= from && value <= to);
    const told = "This point was reached by following the motion from its neighbour; opened on its own it starts from the same state, and shows the same motion.";
    return twofold ? `${told} Two motions exist here.` : told;
  }

  /** @param {(name: string) => any} value of a column; undefined while the point is not solved */
  fill(value) {
    const error = value("error");
    const solved = error !== undefined;
    /** @param {PointKind[]} kinds @param {string | undefined} word */
    const kind = (kinds, word) => (word ? `${word}: ${kinds.find(({ is }) => is(word))?.detail ?? ""}` : null);
    /** @type {ValueRow[]} */
    const rows = QUANTITIES.flatMap(({ label, unit, columns }) => {
      const values = Object.values(columns).map(value);
      if (values.every((one) => one === null || one === undefined)) return [];
      return [[values.length > 1 ? `${label}, left / right` : label, values.map((one) => number(one)).join(" / "), unit]];
    });
    fillValues(byId("sweep-point-values"), [["Motion", kind(REGIMES, value("regime"))], ["Contact", kind(CONTACTS, value("contact"))], ...rows]);
    const trouble = byId("sweep-point-error");
    show(trouble, Boolean(error) || !solved);
    trouble.textContent = solved ? (error ? `No response: ${error}` : "") : "This point is not solved yet.";
    byId("sweep-open").disabled = Boolean(error);
  }

  /** Submits the point's document and goes to its job. */
  async open() {
    const button = byId("sweep-open");
    button.disabled = true;
    try {
      const document = await api.pointInput(this.sweep.id, this.position);
      const place = `: ${this.grid.describe(this.position)}`;
      document.name = `${this.sweep.name.slice(0, NAME_LENGTH - place.length)}${place}`;
      const job = await api.submit(document, api.newKey());
      window.location.assign(`/jobs/${encodeURIComponent(job.id)}`);
    } catch (error) {
      notify(byId("notice"), error);
      byId("notice").scrollIntoView({ block: "center" });
      button.disabled = false;
    }
  }
}

/**
 * Legend of the strip: the kinds that occur, with their colours and meaning.
 * @param {HTMLElement} node
 * @param {PointKind[]} kinds
 * @param {Set<number>} seen
 */
export function showLegend(node, kinds, seen) {
  node.replaceChildren(...kinds.filter((_, index) => seen.has(index)).map(({ label, detail, colour }) => {
    const swatch = el("span", { class: "swatch" });
    swatch.style.color = `var(${colour})`;
    return el("li", { title: detail }, swatch, `${label}: `, el("span", { class: "detail" }, detail));
  }));
}
