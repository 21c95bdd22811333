// The panel of a sweep: reads its rows while they are solved, and draws the view that is chosen.

import * as api from "../common/api.js";
import { byAnyId, byId, el, fillWarnings, notify, show } from "../common/dom.js";
import { draw, onZoom } from "../common/plots.js";
import { Grid, valueText } from "./axes.js";
import { SPECTRUM, STATES, bifurcation, spectra } from "./clouds.js";
import { curves } from "./curves.js";
import { SweepData } from "./data.js";
import { progressText, showFindings } from "./findings.js";
import { KINDS, map, section } from "./maps.js";
import { PointPanel, showLegend } from "./point.js";
import { ALWAYS, CONTACTS, FAILED, QUANTITIES, REGIMES, columnsOf, quantitiesOf } from "./quantities.js";
import { SPEED, campbell, campbellAt } from "./resonances.js";
import { PointTable } from "./table.js";

/** Pause between two readings of a running sweep: the least, and as a multiple of the last reading's duration. */
const PAUSE_MS = 600;
const PAUSE_FACTOR = 4;
const LONGEST_PAUSE_MS = 10_000;

/** Views with the controls that they use. */
/** @type {Record<string, { label: string, controls: string[] }>} */
const VIEWS = {
  curves: { label: "Curves", controls: ["quantity", "line", "halves", "log", "resonances"] },
  map: { label: "Map", controls: ["quantity", "branch", "halves", "log", "contours"] },
  bifurcation: { label: "Bifurcation", controls: ["state", "line"] },
  spectra: { label: "Spectra", controls: ["line", "branch", "log", "hertz", "resonances"] },
  campbell: { label: "Campbell diagram", controls: ["line"] },
};
const SWITCHES = /** @type {const} */ (["log", "contours", "hertz", "resonances"]);
const CONTROLS = ["quantity", "state", "line", "branch", "halves", "log", "contours", "hertz", "resonances"];

/** @type {Promise<Panel> | null} */
let panel = null;

/**
 * Shows a sweep as far as it is solved; called at each change of the job. Resolves when all that is solved is drawn.
 * @param {{ id: string, job: Job }} sweep
 */
export async function showSweep({ id, job }) {
  panel ??= Panel.open(id, job);
  await (await panel).follow(job);
}

class Panel {
  /** @param {string} id @param {Job} job */
  static async open(id, job) {
    const document = await api.input(id);
    return new Panel(id, job, document);
  }

  /** @param {string} id @param {Job} job @param {JobInput} document */
  constructor(id, job, document) {
    this.grid = new Grid(document);
    /** @type {SweepState} */
    this.sweep = { id, name: job.name ?? "Sweep", data: new SweepData(id, this.grid.total), quantities: quantitiesOf(document), rest: null, orders: null };
    /** @type {string[]} */
    this.record = document.record ?? [];
    this.document = document;
    this.job = job;
    /** @type {SweepView} */
    this.view = {
      grid: this.grid, name: this.grid.axes.length === 2 ? "map" : "curves", quantity: QUANTITIES[0], kind: null, state: STATES[0], line: 0, branch: 0, halves: "both",
      log: false, contours: false, hertz: false, resonances: true, range: null, selected: null, click: (event) => this.clicked(event),
    };
    this.plot = byId("sweep-plot");
    /** @type {Promise<void> | null} */
    this.reading = null;
    /** @type {Promise<void>} */
    this.drawing = Promise.resolve();
    /** @type {Promise<void> | null} */
    this.next = null;
    /** @type {() => void} */
    this.wake = () => {};
    this.stale = false;
    /** Position that the address names, until its row is here. @type {number | null} */
    this.recalled = null;
    /** @param {number} position */
    const select = (position) => this.select(position);
    this.table = new PointTable(this.sweep, this.grid, select);
    this.point = new PointPanel(this.sweep, this.grid, select);
    this.fillControls();
    this.recall();
    byId("sweep-resume").addEventListener("click", () => this.resume());
    byId("sweep-axes").textContent = this.grid.describeAxes();
    // Warnings come when the sweep has ended: below it, so that nothing moves.
    byId("sweep").after(byId("warnings"));
    show(byId("sweep"));
  }

  /** Writes the view into the address, so that it can be linked to and restored by the history of the browser. */
  remember() {
    const { view } = this;
    const told = {
      view: view.name, quantity: view.kind ?? view.quantity.name, state: view.state.name, line: view.line, branch: view.branch, halves: view.halves, point: view.selected,
      from: view.range?.[0] ?? null, to: view.range?.[1] ?? null,
      ...Object.fromEntries(SWITCHES.map((name) => [name, Number(view[name])])),
    };
    const uses = new Set(["view", "point", ...(view.name === "curves" ? ["from", "to"] : []), ...VIEWS[view.name].controls]);
    const kept = Object.entries(told).filter(([name, value]) => uses.has(name) && value !== null).map(([name, value]) => [name, String(value)]);
    window.history.replaceState(window.history.state, "", `#${new URLSearchParams(kept)}`);
  }

  /** Restores the view that the address names. */
  recall() {
    const { view, grid } = this;
    const told = new URLSearchParams(window.location.hash.slice(1));
    const name = told.get("view");
    if (name && VIEWS[name]) view.name = name;
    view.quantity = this.sweep.quantities.find(({ name }) => name === told.get("quantity")) ?? view.quantity;
    if (grid.axes.length === 2 && KINDS.some(({ name }) => name === told.get("quantity"))) view.kind = told.get("quantity");
    view.state = STATES.find(({ name }) => name === told.get("state")) ?? view.state;
    /** @param {string} name @param {number} end */
    const within = (name, end) => {
      const text = told.get(name) ?? "";
      return /^\d+$/.test(text) && Number(text) < end ? Number(text) : null;
    };
    view.line = within("line", grid.lines) ?? view.line;
    view.branch = within("branch", grid.branches.length) ?? view.branch;
    const halves = told.get("halves");
    if (halves === "left" || halves === "right") view.halves = halves;
    for (const name of SWITCHES) if (told.has(name)) view[name] = told.get(name) === "1";
    const [from, to] = ["from", "to"].map((name) => Number(told.get(name) ?? NaN));
    if (view.name === "curves" && to > from) view.range = [from, to];
    this.recalled = within("point", grid.total);
  }

  fillControls() {
    /** @param {string} id @param {[string, string][]} list */
    const options = (id, list) => byAnyId(id).replaceChildren(...list.map(([value, text]) => el("option", { value }, text)));
    const { axes, branches } = this.grid;
    /** @param {{ label: string, unit: string }} named */
    const title = ({ label, unit }) => [label, unit].filter(Boolean).join(", ");
    /** @type {[string, string][]} */
    const kinds = axes.length === 2 ? KINDS.map(({ name, label }) => [name, label]) : [];
    options("sweep-quantity", [...this.sweep.quantities.map((quantity) => /** @type {[string, string]} */ ([quantity.name, title(quantity)])), ...kinds]);
    options("sweep-state", STATES.map((state) => [state.name, title(state)]));
    if (axes[1]) {
      options("sweep-line", this.grid.secondOrder.map((index) => [String(index), valueText(axes[1], axes[1].values[index])]));
      byId("sweep-line-label").textContent = axes[1].label;
      this.view.line = this.grid.secondOrder[0];
    }
    options("sweep-branch", branches.map((branch, index) => [String(index), branch]));
    byId("sweep-views").append(...Object.entries(VIEWS).map(([name, { label }]) => {
      const input = el("input", { type: "radio", name: "sweep-view", value: name, id: `sweep-view-${name}` });
      input.addEventListener("change", () => this.change(() => { this.view.name = name; this.view.range = null; }));
      return el("label", { hidden: true }, input, label);
    }));
    /** @type {Record<string, (view: SweepView, input: any) => void>} */
    const changes = {
      quantity: (view, { value }) => {
        view.quantity = QUANTITIES.find(({ name }) => name === value) ?? view.quantity;
        view.kind = KINDS.some(({ name }) => name === value) ? value : null;
      },
      state: (view, { value }) => { view.state = STATES.find(({ name }) => name === value) ?? view.state; },
      line: (view, { value }) => { view.line = Number(value); },
      branch: (view, { value }) => { view.branch = Number(value); },
      halves: (view, { value }) => { view.halves = value; },
      log: (view, { checked }) => { view.log = checked; },
      contours: (view, { checked }) => { view.contours = checked; },
      hertz: (view, { checked }) => { view.hertz = checked; },
      resonances: (view, { checked }) => { view.resonances = checked; },
    };
    for (const [name, apply] of Object.entries(changes)) {
      byAnyId(`sweep-${name}`).addEventListener("change", (/** @type {Event} */ event) => this.change(() => apply(this.view, event.target)));
    }
  }

  /** Which views have something to show. @returns {Record<string, boolean>} */
  there() {
    const { view, grid, sweep } = this;
    return {
      curves: true, map: grid.axes.length === 2, bifurcation: this.record.includes("poincare"), spectra: this.record.includes("spectrum") && Boolean(sweep.orders),
      campbell: Boolean(campbellAt(sweep.rest, view)),
    };
  }

  /** Shows the controls of the view, and those views that have something to show. */
  arrange() {
    const { view, grid, sweep } = this;
    const there = this.there();
    for (const [name, is] of Object.entries(there)) {
      const input = byAnyId(`sweep-view-${name}`);
      show(input.parentElement, is);
      input.checked = view.name === name;
    }
    show(byId("sweep-views"), Object.values(there).filter(Boolean).length > 1);
    const uses = new Set(VIEWS[view.name].controls);
    if (grid.axes.length < 2) uses.delete("line");
    if (grid.branches.length < 2) uses.delete("branch");
    if (view.kind || view.quantity.columns.both) uses.delete("halves");
    if (view.kind && view.name === "map") ["log", "contours"].forEach((name) => uses.delete(name));
    if (view.name === "spectra" && !campbellAt(sweep.rest, view)) uses.delete("hertz");
    if (grid.axes[0].pointer !== SPEED || !campbellAt(sweep.rest, view)) uses.delete("resonances");
    for (const name of CONTROLS) show(byAnyId(`sweep-${name}`).closest(".control"), uses.has(name));
    byId("sweep-quantity").value = view.kind ?? view.quantity.name;
    byId("sweep-line").value = String(view.line);
    byId("sweep-branch").value = String(view.branch);
    byId("sweep-state").value = view.state.name;
    byId("sweep-halves").value = view.halves;
    for (const name of SWITCHES) byAnyId(`sweep-${name}`).checked = view[name];
  }

  columns(name = this.view.name) {
    const { view } = this;
    if (name === "bifurcation") return [...ALWAYS, view.state.name];
    if (name === "spectra") return [...ALWAYS, SPECTRUM];
    return [...ALWAYS, ...columnsOf(view.quantity)];
  }

  /** Changes the view and draws it. @param {() => void} apply */
  async change(apply) {
    apply();
    this.remember();
    try {
      await this.redraw();
    } catch (error) {
      notify(byId("notice"), error);
    }
  }

  /** @param {number} position */
  async select(position) {
    const { view, grid } = this;
    const { second, branch } = grid.placeOf(position);
    await this.change(() => { Object.assign(view, { selected: position, line: second, branch }); });
    this.table.turnTo(position);
    await this.point.show(position, view);
  }

  /** Takes up a new state of the job; readings do not overlap. @param {Job} job */
  async follow(job) {
    this.job = job;
    this.stale = true;
    // The end is shown without delay.
    if (api.isEnded(job)) this.wake();
    while (this.stale || this.reading) await (this.reading ??= this.read().finally(() => { this.reading = null; }));
  }

  async read() {
    while (this.stale) {
      this.stale = false;
      const { job } = this;
      const started = performance.now();
      await this.sweep.data.require(this.columns());
      let drawn = performance.now();
      await this.sweep.data.refresh(() => {
        // The first page at once, then now and then.
        if (performance.now() - drawn < 500 && this.plot.dataset.points) return;
        drawn = performance.now();
        this.redraw().catch(() => {});
      });
      if (job.state === "succeeded" && !this.sweep.rest) {
        const rest = await api.resultWithoutRows(this.sweep.id);
        this.sweep.rest = rest;
        this.sweep.orders = rest.sweep?.spectrum_mesh_orders ?? null;
        fillWarnings(byId("warnings"), rest.warnings);
      }
      await this.redraw();
      await this.table.update();
      if (this.recalled !== null && this.sweep.data.here[this.recalled]) {
        const position = this.recalled;
        this.recalled = null;
        await this.select(position);
      }
      if (api.isEnded(job)) continue;
      const pause = Math.min(LONGEST_PAUSE_MS, Math.max(PAUSE_MS, PAUSE_FACTOR * (performance.now() - started)));
      await new Promise((/** @type {(value?: unknown) => void} */ resolve) => {
        this.wake = resolve;
        if (api.isEnded(this.job)) resolve();
        setTimeout(resolve, pause);
      });
    }
  }

  /** One drawing after the other, and not more than one waiting. */
  redraw() {
    this.next ??= this.drawing.then(() => {
      this.next = null;
      return this.drawNow();
    });
    this.drawing = this.next.catch(() => {});
    return this.next;
  }

  async drawNow() {
    const { view, sweep, plot, grid } = this;
    if (sweep.rest && !this.there()[view.name]) view.name = grid.axes.length === 2 ? "map" : "curves";
    // The view that the address names may need the end of the sweep.
    const name = this.there()[view.name] ? view.name : "curves";
    const columns = [...new Set([...this.columns(name), ...columnsOf(view.quantity)])];
    // Rows that are here are drawn while more are read.
    if (!sweep.data.has(columns)) await sweep.data.require(columns);
    this.arrange();
    byId("sweep-count").textContent = progressText(sweep, this.job);
    const resumable = ["canceled", "failed"].includes(this.job.state) && sweep.data.n < sweep.data.total;
    show(byId("sweep-resume-box"), resumable);
    showFindings(sweep, view, (position) => this.select(position));
    // Axes without a point have no range.
    if (!sweep.data.n) return;
    /** @type {Record<string, (sweep: SweepState, view: SweepView) => Plot | null>} */
    const plots = { curves, map, bifurcation, spectra, campbell };
    const picture = plots[name](sweep, view);
    if (!picture) return;
    await draw(plot, picture.traces, picture.axes);
    onZoom(plot, (range) => this.zoomed(range));
    plot.dataset.points = String(sweep.data.n);
    plot.dataset.view = name;
    this.showKinds();
    await this.drawSections();
  }

  showKinds() {
    const { view, sweep } = this;
    /** @type {Record<string, PointKind[]>} */
    const all = { regime: [...REGIMES, FAILED], contact: CONTACTS };
    /** @type {Record<string, string[]>} */
    const words = { regime: sweep.data.column("regime"), contact: sweep.data.column("contact") };
    const errors = sweep.data.column("error");
    for (const name of ["regime", "contact"]) {
      const node = byAnyId(`sweep-${name}-legend`);
      const wanted = view.name === "curves" || (view.name === "map" && view.kind === name);
      show(node, wanted);
      if (!wanted) continue;
      const seen = new Set();
      for (let at = 0; at < words[name].length; at += 1) {
        if (errors[at]) seen.add(REGIMES.length + (name === "regime" ? 0 : 100));
        else if (words[name][at]) seen.add(all[name].findIndex((kind) => kind.is?.(words[name][at])));
      }
      showLegend(node, all[name], seen);
    }
  }

  async drawSections() {
    const { view, sweep, grid } = this;
    const { selected } = view;
    const wanted = view.name === "map" && selected !== null && !view.kind && grid.axes.length === 2;
    show(byId("sweep-sections"), wanted);
    if (!wanted) return;
    for (const along of [0, 1]) {
      const { traces, axes, title } = section(sweep, { ...view, selected }, along);
      byAnyId(`sweep-section-title-${along}`).textContent = title;
      await draw(byAnyId(`sweep-section-${along}`), traces, axes);
    }
  }

  /** Selects the point of a plot that was clicked. @param {any} event of plotly */
  clicked({ points }) {
    /** @type {number | undefined} */
    const position = points.map(({ customdata }) => customdata).find((/** @type {unknown} */ value) => Number.isInteger(value));
    if (position !== undefined) this.select(position);
  }

  /** Finer lines after zooming in. @param {Span | null} range */
  zoomed(range) {
    if (this.view.name !== "curves") return;
    const wanted = range && this.grid.axes[0].logarithmic ? range.map((end) => 10 ** end) : range;
    this.change(() => { this.view.range = wanted; });
  }

  /** Submits the same document again: the new job continues from the solved points. */
  async resume() {
    const button = byId("sweep-resume");
    button.disabled = true;
    try {
      const job = await api.submit(this.document, api.newKey());
      window.location.assign(`/jobs/${encodeURIComponent(job.id)}`);
    } catch (error) {
      notify(byId("notice"), error);
      button.disabled = false;
    }
  }
}
