// Time series of one or two channels. Zooming in fetches finer data; the record of a periodic motion is shown several
// times.

import * as api from "../common/api.js";
import { decimal } from "../common/csv.js";
import { byId, download, el, notify, show } from "../common/dom.js";
import { number, sentence } from "../common/format.js";
import { draw, line, onZoom } from "../common/plots.js";
import { remember, told } from "./address.js";
import { Listening } from "./listen.js";
import { halvesAlike } from "./motion_plots.js";
import { channelScale, channelWords } from "./words.js";

const MAX_POINTS = 2000;
/** Mesh periods shown at least. */
const PERIODS = 3;
/** More lines of mesh periods would hide the curve. */
const MAX_LINES = 40;
const QUANTITIES = ["displacement", "velocity", "acceleration", "force", "rotation", "angular_velocity", "angular_acceleration"];

/** @param {JobContext} context */
export async function showSeries({ id, result: { response, numerics }, catalogue }) {
  if (!catalogue.length) return;
  show(byId("series"));
  await new SeriesPanel(id, catalogue, response, halvesAlike(numerics)).load();
}

class SeriesPanel {
  /**
   * @param {string} id
   * @param {SeriesChannel[]} catalogue
   * @param {ResponseResult | null | undefined} response
   * @param {boolean} alike whether the halves have the same curves
   */
  constructor(id, catalogue, response, alike) {
    this.id = id;
    this.channels = new Map(catalogue.map((channel) => [channel.name, channel]));
    /** @type {Span | null} */
    this.window = null;
    /** @type {AbortController | null} */
    this.asking = null;
    this.plot = byId("series-plot");
    this.first = byId("channel");
    this.second = byId("second-channel");
    this.first.append(...groups(catalogue));
    this.second.append(el("option", { value: "" }, "no other"), ...groups(catalogue));
    this.first.value = ["x_left", "s_left"].find((name) => this.channels.has(name)) ?? catalogue[0].name;
    const partner = this.first.value.replace(/left$/, "right");
    // Equal halves have the same curve.
    if (!alike && partner !== this.first.value && this.channels.has(partner)) this.second.value = partner;
    this.first.addEventListener("change", () => this.change());
    this.second.addEventListener("change", () => this.change());
    document.getElementById("csv-decimal")?.addEventListener("change", () => this.linkFile());
    byId("whole").addEventListener("click", () => this.zoom(null));
    byId("series-csv").addEventListener("click", (event) => this.save(event));
    byId("series-npz").href = api.seriesFileUrl(id, "npz");
    byId("series-mat").href = api.seriesFileUrl(id, "mat");
    this.listening = new Listening(id, catalogue);
    const frequency = response?.mesh_frequency_hz ?? 0;
    this.meshPeriod = frequency > 0 ? 1 / frequency : null;
    const { n, dt, t0 } = catalogue[0];
    this.start = t0;
    this.length = n * dt;
    // A periodic record is repeated, so that its continuation is visible.
    const repeats = response?.method === "periodic" && this.meshPeriod;
    this.copies = repeats ? Math.max(1, Math.ceil(PERIODS / Math.max(1, response.period_mesh_periods ?? 1))) : 1;
    /** @type {Span} */
    this.whole = [t0, t0 + this.copies * this.length];
    this.recall();
  }

  /** Restores channels and window that the address names. */
  recall() {
    const named = told();
    const [first, second] = [named.get("channel"), named.get("second")];
    if (first && this.channels.has(first)) {
      this.first.value = first;
      this.second.value = second && this.channels.has(second) ? second : "";
    }
    const [from, to] = ["from", "to"].map((name) => Number(named.get(name) ?? NaN) / 1e3);
    if (to > from && from >= this.whole[0] - this.length && to <= this.whole[1] + this.length) this.window = [from, to];
  }

  /** Takes up other channels or another window: they stand in the address from then on. */
  change() {
    const [from, to] = (this.window ?? []).map((end) => String(Number((end * 1e3).toPrecision(9))));
    remember({ channel: this.first.value, second: this.second.value, from: from ?? null, to: to ?? null });
    return this.load();
  }

  linkFile() {
    this.listening.choose(this.first.value);
    byId("series-csv").href = api.seriesCsvUrl(this.id, this.first.value, decimal());
  }

  /** Shows a window [from, to] in seconds, or all. @param {Span | null} window */
  zoom(window) {
    this.window = window;
    return this.change();
  }

  async load() {
    this.asking?.abort();
    this.asking = new AbortController();
    const { signal } = this.asking;
    const names = [...new Set([this.first.value, this.second.value].filter(Boolean))];
    this.linkFile();
    this.plot.dataset.state = "loading";
    try {
      const answers = await Promise.all(names.map((name) => this.fetch(name, signal)));
      if (signal.aborted) return;
      await this.show(names, answers);
      this.plot.dataset.state = "ready";
    } catch (error) {
      if (!signal.aborted) notify(byId("notice"), error);
    }
  }

  /**
   * The part of the record that the window needs, put where it is shown.
   * @param {string} name
   * @param {AbortSignal} signal
   */
  async fetch(name, signal) {
    const [from, to] = this.window ?? this.whole;
    const copy = this.window ? Math.floor((from - this.start) / this.length) : 0;
    const shift = copy * this.length;
    const within = this.window && (this.copies === 1 || to <= this.start + shift + this.length);
    const parameters = within ? { from: from - (this.copies === 1 ? 0 : shift), to: to - (this.copies === 1 ? 0 : shift) } : {};
    const { t, y, n_source: source, n_returned: returned, method } = await api.series(this.id, name, { ...parameters, max_points: MAX_POINTS }, signal);
    const told = { source, returned, method };
    if (this.copies === 1) return { t, y, ...told };
    if (within) return { t: t.map((time) => time + shift), y, ...told };
    // A periodic record ends one sample before it begins again.
    const copies = Array.from({ length: this.copies }, (_, index) => index);
    return { t: [...copies.flatMap((index) => t.map((time) => time + index * this.length)), this.whole[1]], y: [...copies.flatMap(() => y), y[0]], ...told };
  }

  /** @param {string[]} names @param {Awaited<ReturnType<SeriesPanel["fetch"]>>[]} answers */
  async show(names, answers) {
    const scales = names.map((name) => channelScale(this.channel(name).unit));
    const traces = answers.map(({ t, y }, index) => ({
      ...line(t.map((time) => time * 1e3), y.map((value) => (value === null ? null : value * scales[index].factor)), channelWords(names[index])),
      yaxis: scales[index].unit === scales[0].unit ? "y" : "y2",
    }));
    const [from, to] = this.window ?? (this.copies > 1 ? this.whole : [answers[0].t[0], answers[0].t[answers[0].t.length - 1]]);
    /** @type {PlotAxes} */
    const axes = {
      x: "Time, ms",
      y: { label: this.quantityOf(names[0]), unit: scales[0].unit },
      y2: traces.some(({ yaxis }) => yaxis === "y2") ? { label: this.quantityOf(names[1]), unit: scales[1].unit } : undefined,
      range: [from * 1e3, to * 1e3],
      zoomX: true,
      marks: this.periodsBetween(from, to),
      csvName: `series-${names.join("-")}`,
    };
    if (this.meshPeriod) axes.top = { title: "Mesh periods", factor: 1e-3 / this.meshPeriod };
    await draw(this.plot, traces, axes);
    onZoom(this.plot, (window) => this.zoom(window && [window[0] / 1e3, window[1] / 1e3]));
    this.note(answers[0], to - from);
  }

  /** @param {string} name */
  channel(name) {
    const channel = this.channels.get(name);
    if (!channel) throw new Error(`there is no channel ${name}`);
    return channel;
  }

  /** @param {string} name */
  quantityOf(name) {
    return sentence(this.channel(name).quantity.replaceAll("_", " "));
  }

  /** @param {number} from @param {number} to */
  periodsBetween(from, to) {
    const { meshPeriod: period } = this;
    if (!period) return [];
    const first = Math.ceil((from - this.start) / period - 1e-9);
    const last = Math.floor((to - this.start) / period + 1e-9);
    if (last - first > MAX_LINES) return [];
    return Array.from({ length: Math.max(0, last - first + 1) }, (_, index) => ({ x: (this.start + (first + index) * period) * 1e3 }));
  }

  note({ source, returned, method }, span) {
    const complete = returned >= source;
    const how = complete ? `All ${number(source)} samples` : `${number(returned)} of ${number(source)} samples (${method})`;
    const periods = this.meshPeriod ? `, ${number(span / this.meshPeriod, 3)} mesh periods` : "";
    const repeated = this.copies > 1 ? ` The record is one period of the motion; it is shown ${this.copies} times.` : "";
    const hint = complete ? "" : " Zoom in for more detail.";
    byId("series-note").textContent = `${how}, ${number(span * 1e3, 4)} ms${periods}.${repeated}${hint} Dotted: starts of mesh periods. Double-click or “Whole record” shows all again.`;
    this.plot.dataset.samples = String(source);
    this.plot.dataset.points = String(returned);
  }

  /** @param {Event} event */
  async save(event) {
    event.preventDefault();
    try {
      download(`${this.first.value}.csv`, await api.seriesCsv(this.id, this.first.value, decimal()), "text/csv");
    } catch (error) {
      notify(byId("notice"), error);
    }
  }
}

/** Options by quantity, in the units in which they are shown. @param {SeriesChannel[]} catalogue */
function groups(catalogue) {
  /** @param {SeriesChannel} channel */
  const rank = ({ quantity }) => (QUANTITIES.indexOf(quantity) + 1 || QUANTITIES.length + 1);
  const quantities = [...new Set([...catalogue].sort((a, b) => rank(a) - rank(b)).map(({ quantity }) => quantity))];
  return quantities.map((quantity) => {
    const channels = catalogue.filter((channel) => channel.quantity === quantity);
    const label = `${sentence(quantity.replaceAll("_", " "))}, ${channelScale(channels[0].unit).unit}`;
    const group = el("optgroup", {}, ...channels.map(({ name }) => el("option", { value: name }, `${channelWords(name)}${/^[va]_/.test(name) ? `: ${name}` : ""}`)));
    group.label = label;
    return group;
  });
}
