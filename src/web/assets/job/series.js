// Time series with zoom, phase plane and spectrum.

import * as api from "../common/api.js";
import { byId, download, el, notify, show } from "../common/dom.js";
import { number, sentence, shownUnit } from "../common/format.js";
import { draw, line, onZoom, points, stems } from "../common/plots.js";

const MAX_POINTS = 2000;
/** Most points of the phase plane: its two channels have to be complete over the time shown. */
const PHASE_POINTS = 20_000;

export async function showSeries(id, job, { response }, catalogue) {
  show(byId("series"));
  const panel = new SeriesPanel(id, catalogue, response);
  await panel.load();
  await showPhase(id, response, catalogue);
  await showSpectrum(response);
}

class SeriesPanel {
  constructor(id, catalogue, response) {
    this.id = id;
    this.channels = new Map(catalogue.map((channel) => [channel.name, channel]));
    this.window = null;
    this.asking = null;
    this.plot = byId("series-plot");
    this.first = byId("channel");
    this.second = byId("second-channel");
    this.first.append(...catalogue.map(({ name, quantity, unit }) => el("option", { value: name }, optionText(name, quantity, unit))));
    this.second.append(el("option", { value: "" }, "no other"), ...catalogue.map(({ name }) => el("option", { value: name }, name)));
    this.first.value = this.channels.has("x_left") ? "x_left" : catalogue[0].name;
    if (this.channels.has("x_right")) this.second.value = "x_right";
    this.first.addEventListener("change", () => this.load());
    this.second.addEventListener("change", () => this.load());
    byId("whole").addEventListener("click", () => this.zoom(null));
    byId("series-csv").addEventListener("click", (event) => this.save(event));
    this.meshPeriod = response?.mesh_frequency_hz > 0 ? 1 / response.mesh_frequency_hz : null;
  }

  /** Shows a window [from, to] in seconds, or the whole record. */
  zoom(window) {
    this.window = window;
    return this.load();
  }

  async load() {
    this.asking?.abort();
    this.asking = new AbortController();
    const { signal } = this.asking;
    const names = [...new Set([this.first.value, this.second.value].filter(Boolean))];
    const [from, to] = this.window ?? [];
    byId("series-csv").href = api.seriesUrl(this.id, names[0]);
    this.plot.dataset.state = "loading";
    try {
      const parameters = { from, to, max_points: MAX_POINTS };
      const answers = await Promise.all(names.map((name) => api.series(this.id, name, parameters, signal)));
      if (signal.aborted) return;
      const unit = shownUnit(this.channels.get(names[0]).unit);
      const traces = answers.map(({ t, y }, index) => ({ ...line(t, y, names[index]), yaxis: this.axisOf(names, index) }));
      const other = traces.some((trace) => trace.yaxis === "y2") ? shownUnit(this.channels.get(names[1]).unit) : null;
      await draw(this.plot, traces, { x: "Time, s", y: `${names[0]}, ${unit}`, y2: other && `${names[1]}, ${other}`, range: this.window });
      onZoom(this.plot, (window) => this.zoom(window));
      this.note(answers[0]);
      this.plot.dataset.state = "ready";
    } catch (error) {
      if (!signal.aborted) notify(byId("notice"), error);
    }
  }

  /** A second channel of another unit has an axis of its own. */
  axisOf(names, index) {
    return index === 0 || this.channels.get(names[0]).unit === this.channels.get(names[1]).unit ? "y" : "y2";
  }

  note({ n_source: source, n_returned: returned, method, t }) {
    const span = t.length > 1 ? t.at(-1) - t[0] : 0;
    const periods = this.meshPeriod ? `, ${number(span / this.meshPeriod, 3)} mesh periods` : "";
    const complete = returned >= source;
    const how = complete ? `all ${number(source)} samples` : `${number(returned)} of ${number(source)} samples (${method})`;
    const hint = complete ? "" : " Zoom in for more detail.";
    byId("series-note").textContent = `${sentence(how)}, ${number(span, 3)} s${periods}.${hint}`;
    this.plot.dataset.samples = String(source);
    this.plot.dataset.points = String(returned);
  }

  async save(event) {
    event.preventDefault();
    try {
      download(`${this.first.value}.csv`, await api.seriesCsv(this.id, this.first.value), "text/csv");
    } catch (error) {
      notify(byId("notice"), error);
    }
  }
}

function optionText(name, quantity, unit) {
  return `${name} – ${quantity ? `${quantity.replaceAll("_", " ")}, ` : ""}${shownUnit(unit)}`;
}

async function showPhase(id, response, catalogue) {
  const names = ["x_left", "v_x_left"];
  const channel = catalogue.find(({ name }) => name === names[0]);
  if (!channel || !catalogue.some(({ name }) => name === names[1])) return;
  show(byId("phase"));
  const { t0, t_end: end, n, dt } = channel;
  const from = n > PHASE_POINTS ? end - PHASE_POINTS * dt : t0;
  const [x, v] = await Promise.all(names.map((name) => api.series(id, name, { from, to: end, method: "none" })));
  const micrometres = (values) => values.map((value) => value * 1e6);
  // A periodic record ends one sample before it begins again.
  const closed = (values) => (response?.method === "periodic" ? [...values, values[0]] : values);
  const traces = [line(closed(micrometres(x.y)), closed(v.y), "path")];
  const { x_left_m: px = [], v_x_left_m_s: pv = [] } = response?.poincare ?? {};
  if (px.length) traces.push(points(micrometres(px), pv, "once per mesh period"));
  await draw(byId("phase-plot"), traces, { x: "x_left, µm", y: "v_x_left, m/s" });
  byId("phase-note").textContent = `${number(x.n_returned)} samples of the record's end${px.length ? `; ${number(px.length)} ${px.length === 1 ? "point" : "points"}, one per mesh period` : ""}.`;
}

async function showSpectrum(response) {
  const spectrum = response?.spectrum;
  if (!spectrum?.frequency_hz?.length) return;
  show(byId("spectrum"));
  await draw(byId("spectrum-plot"), [stems(spectrum.frequency_hz, spectrum.amplitude_m_s2, "amplitude")], { x: "Frequency, Hz", y: "m/s²", fromZero: true });
  const mesh = response.mesh_frequency_hz;
  byId("spectrum-note").textContent = mesh ? `Mesh frequency ${number(mesh)} Hz.` : "";
}
