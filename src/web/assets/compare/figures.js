// The curves of all jobs, one above the other: the same colour and dash for a job in every figure.

import * as api from "../common/api.js";
import { byAnyId, byId, el, show } from "../common/dom.js";
import { number, shownUnit } from "../common/format.js";
import { bars, draw, line, points, stems } from "../common/plots.js";
import { nameOfBearing } from "../job/shafts_plots.js";
import * as address from "./address.js";

/** Channel that is shown at first. */
const USUAL = "a_x";
const PHASE = "Position in the mesh period";
/** Points of a record that a figure shows at most. */
const MAX_POINTS = 4000;
/** Mesh periods of an integrated motion in the phase plane. */
const PHASE_PERIODS = 40;
/** A spectrum with more lines than this is drawn as a curve. */
const MAX_BARS = 48;

/** @param {string} id @returns {HTMLElement} */
const plotOf = (id) => byAnyId(id).querySelector(".plot");
const options = () => ({
  half: /** @type {HTMLInputElement} */ (document.querySelector("#half input:checked")).value,
  isMeanRemoved: byId("mean-removed").checked,
  channel: byId("channel").value,
  periods: Number(byId("periods").value),
  isLogarithmic: byId("spectrum-log").checked,
});

/** @typedef {ComparedJob & { result: JobResult }} SolvedJob */

/** @type {SolvedJob[]} */
let jobs = [];
/** Requests of series by job, channel and window. @type {Map<string, Promise<SeriesData>>} */
let series = new Map();
let drawing = 0;

/** @param {(error: unknown) => void} failed */
export function watchOptions(failed) {
  const isOn = (/** @type {string | null} */ word) => word === "1";
  recall();
  const changed = () => {
    const { half, isMeanRemoved, channel, periods, isLogarithmic } = options();
    address.remember({ half: half === "left" ? "" : half, mean: isMeanRemoved ? "removed" : "", channel: channel === USUAL ? "" : channel, periods: periods === 2 ? "" : String(periods), log: isLogarithmic ? "1" : "" });
    update().catch(failed);
  };
  for (const id of /** @type {const} */ (["half", "mean-removed", "channel", "periods", "spectrum-log"])) byId(id).addEventListener("change", changed);

  /** Restores what the address names; the channels are known later. */
  function recall() {
    const told = address.told();
    const half = /** @type {HTMLInputElement | null} */ (document.querySelector(`#half input[value="${told.get("half") === "right" ? "right" : "left"}"]`));
    if (half) half.checked = true;
    byId("mean-removed").checked = told.get("mean") === "removed";
    byId("spectrum-log").checked = isOn(told.get("log"));
    const periods = byId("periods");
    if ([...periods.options].some(({ value }) => value === told.get("periods"))) periods.value = told.get("periods") ?? "";
  }
}

/** Draws the curves of these jobs, as far as they have them. @param {ComparedJob[]} all */
export async function showCurves(all) {
  jobs = all.filter(isSolved);
  series = new Map([...series].filter(([key]) => jobs.some(({ id }) => key.startsWith(id))));
  const symmetric = jobs.every(isSymmetric);
  show(byId("half"), !symmetric);
  byId("half-note").textContent = symmetric ? "The halves are alike: the left one is shown." : "";
  fillChannels();
  show(byId("curves"), jobs.length > 0);
  await update();
}

/** @type {(job: ComparedJob) => job is SolvedJob} */
const isSolved = (job) => job.result !== undefined;

/** @param {SolvedJob} job */
function isSymmetric({ result }) {
  const rms = result.response?.rms?.mesh_circumferential_acceleration_m_s2;
  const alike = !rms || Math.abs(rms.left - rms.right) <= 1e-6 * Math.abs(rms.left);
  return alike && !result.mesh?.right_curve;
}

/** Channels that some job has, by the name that they have in either half. */
function fillChannels() {
  const known = new Map();
  for (const { channels = [] } of jobs) for (const { name, quantity, unit } of channels) if (name.endsWith("_left")) known.set(name.slice(0, -5), { quantity, unit });
  const choice = byId("channel");
  const chosen = choice.value || address.told().get("channel") || USUAL;
  choice.replaceChildren(...[...known].map(([name, { quantity, unit }]) => el("option", { value: name }, `${name}${quantity ? ` – ${quantity.replaceAll("_", " ")}` : ""}, ${inUnit(unit).unit}`)));
  if (known.has(chosen)) choice.value = chosen;
  else if (known.has(USUAL)) choice.value = USUAL;
}

async function update() {
  const turn = ++drawing;
  const wanted = options();
  const later = records(wanted).then((figures) => Promise.all(turn === drawing ? figures.map(put) : []));
  await Promise.all([...curves(wanted).map(put), later]);
  if (turn === drawing) byId("curves").dataset.ready = String(turn);
}

/**
 * A figure of all jobs that have something for it.
 * @typedef {{ id: string, traces: Trace[], axes: PlotAxes }} Figure
 * @type {(id: string, traces: Trace[], axes: PlotAxes) => Figure}
 */
const figure = (id, traces, axes) => ({ id, traces: traces.filter(({ x }) => x?.length), axes });

/** Shows a figure, or hides it where no job has anything for it. @param {Figure} figure */
async function put({ id, traces, axes }) {
  show(byAnyId(id), traces.length > 0);
  if (traces.length) await draw(plotOf(id), traces, axes);
}

/** Figures of what is read already. @param {Options} options */
const curves = (options) => [
  meshCurve("stiffness", "Mesh stiffness", "N/µm", (curve) => curve.stiffness_n_per_um, options), meshCurve("error", "Transmission error", "µm", (curve) => curve.transmission_error_um, options),
  share(options), faceLoad(), impact(), bearingForces(), spectrum(options),
];

/** All figures of these jobs, for a report. @param {ComparedJob[]} all @param {Options} options */
export async function figuresOf(all, options) {
  jobs = all.filter(isSolved);
  return [...curves(options), ...(await records(options))].filter(({ traces }) => traces.length);
}

/** The options in the address, as a report takes them. @returns {Options} */
export function optionsTold() {
  const told = address.told();
  return { half: told.get("half") ?? "left", isMeanRemoved: told.get("mean") === "removed", channel: told.get("channel") ?? USUAL, periods: Number(told.get("periods") ?? 2), isLogarithmic: told.get("log") === "1" };
}

/** @type {(job: ComparedJob, trace: Trace) => Trace} */
const styledFor = ({ slot }, trace) => ({ ...trace, colour: slot });
/** @param {SolvedJob} job @param {string} half */
const curveOf = ({ result }, half) => (half === "right" ? result.mesh?.right_curve : null) ?? result.mesh?.curve;

/** @param {number[]} values @param {boolean} isMeanRemoved */
function withoutMean(values, isMeanRemoved) {
  if (!isMeanRemoved || !values.length) return values;
  const mean = values.reduce((sum, value) => sum + value, 0) / values.length;
  return values.map((value) => value - mean);
}

/** @typedef {ReturnType<typeof options>} Options */

/**
 * @param {string} id
 * @param {string} label
 * @param {string} unit
 * @param {(curve: MeshCurve) => number[]} pick
 * @param {Options} options
 */
function meshCurve(id, label, unit, pick, { half, isMeanRemoved }) {
  const traces = jobs.map((job) => {
    const curve = curveOf(job, half);
    const values = curve ? withoutMean(pick(curve), isMeanRemoved) : [];
    if (!curve || !values.length) return { x: [] };
    // The period closes: its end is its beginning.
    return styledFor(job, line([...curve.phase, curve.phase[0] + 1], [...values, values[0]], job.short));
  });
  return figure(id, traces, { x: PHASE, y: { label: `${label}${isMeanRemoved ? " from the mean" : ""}`, unit }, link: "mesh", csvName: `compare-${id}` });
}

/** @param {Options} options */
function share({ half }) {
  const traces = jobs.map((job) => {
    const curve = job.result.mesh?.curve;
    const shares = curve?.load_share ?? [];
    const values = shares[half === "right" && shares.length > 1 ? 1 : 0];
    return curve && values ? styledFor(job, line(curve.load_share_phase, values, job.short)) : { x: [] };
  });
  return figure("share", traces, { x: "Base pitches from the theoretical start of contact", y: "Share of the load", csvName: "compare-load-share" });
}

/** Line load along both faces, from the middle of the gap outwards. */
function faceLoad() {
  const traces = jobs.flatMap((job) => {
    const { shafts } = job.result;
    const { gap_width_mm: gap = 0 } = job.input?.design ?? {};
    if (!shafts) return [];
    return /** @type {const} */ (["left", "right"]).map((half) => {
      const { station_from_inner_end_mm: stations, line_load_n_per_mm: load } = shafts[half];
      const places = stations.map((inner) => (half === "left" ? -1 : 1) * (gap / 2 + inner));
      return { ...styledFor(job, line(places, load, job.short)), showlegend: half === "left" };
    });
  });
  return figure("face-load", traces, { x: "From the middle of the gap, mm", y: "Line load, N/mm", csvName: "compare-line-load", hover: "closest" });
}

/** Dynamic forces of all bearings: RMS of each along every axis. */
function bearingForces() {
  const traces = jobs.map((job) => {
    const forces = (job.result.response?.bearings ?? []).flatMap((bearing) => /** @type {const} */ (["x", "y", "z"]).map((axis) => ({ name: `${nameOfBearing(bearing)}, ${axis}`, rms: bearing.force_n[axis].rms })));
    const moved = forces.filter(({ rms }) => rms > 1e-6);
    return { ...styledFor(job, bars(moved.map(({ name }) => name), moved.map(({ rms }) => rms), job.short)), showlegend: true };
  });
  return figure("bearing-forces", traces, { x: "Bearing and axis", y: "RMS of the force, N", csvName: "compare-bearing-forces", hover: "closest", layout: { barmode: "group" } });
}

/** The pulses: half sines from the corner's first touch. */
function impact() {
  const traces = jobs.map((job) => {
    const { impact: found, geometry, response } = job.result;
    const frequency = response?.mesh_frequency_hz ?? geometry?.mesh_frequency_hz;
    if (!found || typeof frequency !== "number") return { x: [] };
    const { force_n: force, duration_us: duration, start_mesh_periods: start } = found;
    const length = duration * 1e-6 * frequency;
    const steps = Array.from({ length: 61 }, (_, index) => index / 60);
    return styledFor(job, line(steps.map((step) => start + step * length), steps.map((step) => force * Math.sin(Math.PI * step)), job.short));
  });
  return figure("impact", traces, { x: "Mesh periods from the theoretical start of contact", y: "Impact force, N", csvName: "compare-impact" });
}

/** @param {Options} options */
function spectrum({ isLogarithmic }) {
  const found = jobs.flatMap((job) => {
    const { spectrum: lines, mesh_frequency_hz: frequency = 0 } = job.result.response ?? {};
    return lines?.frequency_hz.length && frequency > 0 ? [{ job, frequency, spectrum: lines }] : [];
  });
  /** @param {{ frequency_hz: number[] }} lines */
  const isFew = (lines) => lines.frequency_hz.length <= MAX_BARS;
  const areFew = found.every(({ spectrum: lines }) => isFew(lines));
  const traces = found.map(({ job, frequency, spectrum: lines }) => {
    const orders = lines.frequency_hz.map((hertz) => Math.round((hertz / frequency) * 1e6) / 1e6);
    const kind = areFew ? bars : isFew(lines) ? stems : line;
    return styledFor(job, { ...kind(orders, lines.amplitude_m_s2, job.short), showlegend: true });
  });
  return figure("spectrum", traces, { x: "Mesh order", y: "Amplitude of acceleration, m/s²", log: isLogarithmic, csvName: "compare-spectrum", hover: "closest" });
}

/** Time series and phase plane: both need records of the motion. @param {Options} options */
async function records({ half, isMeanRemoved, channel, periods }) {
  const moving = jobs.filter(({ channels = [] }) => channels.length > 0);
  /** @param {string[]} names @param {number} count */
  const read = (names, count) => Promise.all(moving.map((job) => Promise.all(names.map((name) => record(job, `${name}_${half}`, count)))));
  const [chosen, planes] = await Promise.all([read([channel], periods), read(["x", "v_x"], PHASE_PERIODS)]);
  const { unit, factor } = inUnit(moving.map((job) => channelOf(job, `${channel}_${half}`)).find(Boolean)?.unit);
  const traces = moving.map((job, index) => {
    const [found] = chosen[index];
    if (!found) return { x: [] };
    const values = withoutMean(found.values, isMeanRemoved).map((value) => value * factor);
    return styledFor(job, line(...repeated(found, values, periods), job.short));
  });
  const series = figure("series", traces, { x: "Time in mesh periods", y: `${channel}_${half}${isMeanRemoved ? " from the mean" : ""}, ${unit}`, zoomX: true, csvName: `compare-${channel}-${half}` });
  const paths = moving.map((job, index) => {
    const [x, v] = planes[index];
    if (!x || !v) return { x: [] };
    const close = (values) => (x.isPeriodic ? [...values, values[0]] : values);
    const path = (x.isPeriodic || x.values.length <= MAX_POINTS ? line : points)(close(x.values.map((value) => value * 1e6)), close(v.values), job.short);
    return styledFor(job, path);
  });
  const plane = figure("phase", paths, { x: `x_${half}, µm`, y: `v_x_${half}, m/s`, hover: "closest", csvName: "compare-phase-plane" });
  return [series, plane];
}

/** @param {ComparedJob} job @param {string} name */
const channelOf = ({ channels = [] }, name) => channels.find((channel) => channel.name === name);

/** Metres are shown as micrometres, other units as they are. @param {string} [unit] */
const inUnit = (unit) => (unit === "m" ? { unit: "µm", factor: 1e6 } : { unit: shownUnit(unit), factor: 1 });

/**
 * The last mesh periods of a channel; the phase is in mesh periods from the start of one.
 * @param {SolvedJob} job
 * @param {string} name
 * @param {number} periods
 */
async function record(job, name, periods) {
  const channel = channelOf(job, name);
  const { response } = job.result;
  if (!channel || !response || !(response.mesh_frequency_hz > 0)) return null;
  const frequency = response.mesh_frequency_hz;
  const { t0, dt, n } = channel;
  const isPeriodic = response.method === "periodic";
  const span = Math.round(n * dt * frequency);
  const count = isPeriodic ? span : Math.min(span, periods);
  const start = t0 + (span - count) / frequency;
  const window = isPeriodic ? { method: "none" } : { from: Math.max(t0, start - dt / 4), to: t0 + (n - 1) * dt, max_points: MAX_POINTS };
  const key = `${job.id} ${name} ${count}`;
  const answer = series.get(key) ?? api.series(job.id, name, window);
  series.set(key, answer);
  try {
    const { t, y } = await answer;
    return { phase: t.map((time) => (time - start) * frequency), values: /** @type {number[]} */ (y), isPeriodic, span: count };
  } catch (error) {
    series.delete(key);
    throw error;
  }
}

/**
 * A periodic record, repeated until it covers `periods`.
 * @param {NonNullable<Awaited<ReturnType<typeof record>>>} record
 * @param {number[]} values
 * @param {number} periods
 * @returns {[number[], number[]]}
 */
function repeated({ phase, values: { length }, isPeriodic, span }, values, periods) {
  if (!isPeriodic || span === 0) return [phase, values];
  const times = Math.max(1, Math.ceil(periods / span));
  /** @type {number[]} */
  const x = [];
  /** @type {number[]} */
  const y = [];
  for (let turn = 0; turn < times; turn += 1) {
    for (let index = 0; index < length; index += 1) {
      if (phase[index] + turn * span > periods) break;
      x.push(phase[index] + turn * span);
      y.push(values[index]);
    }
  }
  const end = Math.min(periods, times * span);
  x.push(end);
  y.push(values[Math.round((end % span) / span * length) % length]);
  return [x, y];
}

export const describeCurves = () => {
  const frequencies = new Set(jobs.map(({ result }) => result.response?.mesh_frequency_hz).filter(Boolean).map((hertz) => number(hertz, 6)));
  return frequencies.size > 1 ? "The mesh frequencies differ: time is counted in mesh periods, frequency in mesh orders." : "";
};
