// The report of one job: everything on paper, plots as drawings.

import * as api from "../common/api.js";
import { bodyOf, byId, el, fillRows, fillValues, fillWarnings, notify, show } from "../common/dom.js";
import { instant, number } from "../common/format.js";
import { gearDataOf, memberRows, pairRows, symbolOf } from "../common/gear_data.js";
import { line } from "../common/plot_traces.js";
import { scalarAt } from "../common/scalars.js";
import { accuracyTexts, headlines } from "../job/headline.js";
import { impactRows, impactValues } from "../job/impact.js";
import { pulsePlot } from "../job/impact_plots.js";
import { meshValues } from "../job/mesh.js";
import { errorPlot, flankPlot, harmonicsPlot, sharePlot, sharingPlot, stiffnessPlot } from "../job/mesh_plots.js";
import { modeRows } from "../job/modes.js";
import { halvesAlike, modesPlot, phasePlot, spectrumPlot } from "../job/motion_plots.js";
import { numericsValues } from "../job/numerics.js";
import { responseValues } from "../job/response.js";
import { bearingOrdersPlot, deflectionPlot, faceLoadPlot, movedAxes, torquePlot, twistPlot } from "../job/shafts_plots.js";
import { channelScale, channelWords } from "../job/words.js";
import { drawPair } from "./drawing.js";
import { HALF, WHOLE, showFigures } from "./figures.js";
import { inputGroups } from "./inputs.js";
import { showShaftsBlock } from "./shafts.js";
import { showSheet } from "./sheet.js";
import { showSweep } from "./sweep.js";

const id = byId("report").dataset.id ?? "";
/** Points of a series on paper. */
const POINTS = 1500;
/** Mesh periods of a series on paper. */
const PERIODS = 8;

/** @param {Job} job */
function showHead(job) {
  show(byId("head"));
  const name = job.name ?? `Job ${job.id.slice(-8)}`;
  byId("title").textContent = name;
  document.title = `${name} · report`;
  byId("subtitle").textContent = "Contact, mesh-in impact and vibration of a double-helical gear pair";
  fillValues(byId("facts"), [
    ["Kind", { mesh: "Mesh", response: "Response at one operating point", sweep: "Sweep", optimise: "Optimisation", tolerance: "Tolerance study" }[job.kind] ?? job.kind],
    ["Label", job.label],
    ["Computed", job.ended_at ? instant(job.ended_at) : null],
    ["Solver", `herringbone ${job.solver_version}`],
    ["Job", el("code", {}, job.id)],
    ["Input hash", el("code", { class: "hash" }, job.input_hash)],
  ]);
}

/** @param {GearData} gearData */
function showGearData(gearData) {
  fillRows(byId("members").tBodies[0], memberRows(gearData).map(({ symbol, name, pinion, gear, unit }) => [name, symbolOf(symbol) ?? "", number(pinion, 6), number(gear, 6), unit]));
  fillRows(byId("pair").tBodies[0], pairRows(gearData).map(({ symbol, name, value, unit }) => [name, symbolOf(symbol) ?? "", number(value, 6), unit]));
  show(byId("gear-data"));
}

/** @param {JobResult} result @param {JobInput} input */
function showResults({ mesh, impact, response }, input) {
  show(byId("results"), Boolean(mesh || impact || response));
  if (response) {
    /** @param {string} pointer @param {PerHalf} sides */
    const row = (pointer, { left, right }) => [scalarAt(pointer).label, number(left), number(right), scalarAt(pointer).unit];
    fillRows(byId("rms").tBodies[0], [row("/response/rms/mesh_circumferential_acceleration_m_s2/{half}", response.rms.mesh_circumferential_acceleration_m_s2), row("/response/rms/pinion_axial_acceleration_m_s2/{half}", response.rms.pinion_axial_acceleration_m_s2)]);
    fillValues(byId("response-values"), responseValues(response, input));
    show(byId("response-block"));
  }
  if (mesh) {
    fillValues(byId("mesh-values"), meshValues(mesh, input));
    show(byId("mesh-block"));
  }
  if (impact) {
    fillRows(byId("impact-table").tBodies[0], impactRows(impact));
    fillValues(byId("impact-values"), impactValues(impact));
    show(byId("impact-block"));
  }
}

/** @param {JobContext} context @param {import("../job/shafts_plots.js").ShaftsDrawing | null} drawing */
async function showPlots({ result: { geometry, mesh, shafts, impact, response, numerics }, input, catalogue, gearData }, drawing) {
  const motion = response ? await motionPlots(response, numerics, input, catalogue) : [];
  /** @type {[string, Plot | null | undefined, typeof HALF?][]} */
  const plots = [
    ["Mesh stiffness of one half", stiffnessPlot(mesh)],
    ["Loaded transmission error of one half", errorPlot(mesh)],
    ["Share of the load of one pair over its path", sharePlot(mesh, gearData)],
    ["Sharing of the load between all pairs in mesh", sharingPlot(mesh)],
    ["Line load on the flanks of a pinion tooth, true to scale", flankPlot(mesh, gearData), WHOLE],
    ["Harmonics of the transmission error", harmonicsPlot(mesh)],
    ["Line load along both faces, on the shafts", faceLoadPlot(shafts, gearData), WHOLE],
    ["Face load factor over the torque", torquePlot(shafts, input.operation?.pinion_torque_nm)],
    ["Deflection of the centre lines", deflectionPlot(shafts, drawing)],
    ["Twist of the shafts from their couplings", twistPlot(shafts, drawing)],
    ["Impact pulse", pulsePlot(impact, geometry?.mesh_frequency_hz)],
    ...motion,
    ["Spectrum of the left circumferential acceleration", response && spectrumPlot(response, numerics)],
    ...movedAxes(response).map((axis) => /** @type {[string, Plot | null]} */ ([`Mesh orders of the bearing forces, ${axis}`, bearingOrdersPlot(response, axis)])),
    ["Natural modes against the harmonics of the mesh frequency", response && modesPlot(response, numerics), WHOLE],
  ];
  const drawn = plots.flatMap(([title, plot, size = HALF]) => (plot ? [{ title, ...plot, size }] : []));
  await showFigures(drawn);
}

/**
 * The last mesh periods of displacement and acceleration of the meshes, and the phase plane over the same time.
 * @param {ResponseResult} response
 * @param {Numerics} numerics
 * @param {JobInput} input
 * @param {SeriesChannel[]} catalogue
 */
async function motionPlots(response, numerics, input, catalogue) {
  const known = new Map(catalogue.map((channel) => [channel.name, channel]));
  /** @param {string} name */
  const channelOf = (name) => {
    const channel = known.get(name);
    if (!channel) throw new Error(`there is no channel ${name}`);
    return channel;
  };
  const period = 1 / response.mesh_frequency_hz;
  /** @param {string} name @param {Record<string, any>} method */
  const last = async (name, method) => {
    const { t_end: end, t0 } = channelOf(name);
    return api.series(id, name, { from: Math.max(t0, end - PERIODS * period), to: end, ...method });
  };
  const halves = halvesAlike(numerics) ? ["left"] : ["left", "right"];
  /** @type {[string, Plot][]} */
  const plots = [];
  for (const [title, base] of [["Mesh displacement along the circumference", "x"], ["Mesh acceleration along the circumference", "a_x"]]) {
    const names = halves.map((half) => `${base}_${half}`).filter((name) => known.has(name));
    if (!names.length) continue;
    const { unit, factor } = channelScale(channelOf(names[0]).unit);
    const traces = (await Promise.all(names.map((name) => last(name, { max_points: POINTS })))).map(({ t, y }, index) => line(t.map((time) => time * 1e3), y.map((value) => (value ?? 0) * factor), halves.length > 1 ? halves[index] : ""));
    plots.push([title, { traces, axes: { x: "Time, ms", y: { label: base === "x" ? "Displacement" : "Acceleration", unit } } }]);
  }
  if (known.has("s_left") && known.has("v_s_left")) {
    /** @param {string} name */
    const exact = async (name) => (await last(name, { method: "none" })).y.map((value) => value ?? 0);
    const paths = await Promise.all(halves.filter((half) => known.has(`s_${half}`) && known.has(`v_s_${half}`)).map(async (half) => {
      /** @param {number[]} values */
      const closed = (values) => (response.method === "periodic" ? [...values, values[0]] : values);
      const [place, velocity] = await Promise.all([`s_${half}`, `v_s_${half}`].map(exact));
      return { half, place: closed(place.map((value) => value * 1e6)), velocity: closed(velocity.map((value) => value * 1e3)) };
    }));
    plots.push([`Phase plane, ${channelWords("s_left").split(",")[1].trim()}`, phasePlot(paths, { x: "Displacement s, µm", y: "Velocity, mm/s", edge: (response.backlash_um ?? input.design?.backlash_um) / 2 })]);
  }
  return plots;
}

/** @param {JobInput} input @param {KindList} kinds */
function showInputs(input, kinds) {
  const schema = kinds.items.find(({ kind }) => kind === input.kind)?.schema;
  const groups = inputGroups(input, schema);
  byId("input-groups").replaceChildren(
    ...groups.map(({ title, rows }) =>
      el("section", {}, el("h3", {}, title), el("dl", { class: "values" }, ...rows.map(({ label, value, unit, differs, usual, help }) =>
        el("div", { class: differs ? "differs" : "", title: help }, el("dt", {}, differs ? "● " : "", label), el("dd", {}, value, unit ? el("span", { class: "unit" }, ` ${unit}`) : null, differs ? el("span", { class: "usual" }, ` (${usual})`) : null))))),
    ),
  );
  show(byId("inputs"), groups.length > 0);
}

/** @param {Accuracy | null} accuracy @returns {ValueRow[]} */
function modelError(accuracy) {
  if (!accuracy) return [];
  const [shown, unit, note] = accuracyTexts(accuracy);
  return [["Error of the model", `${shown} ${unit} ${note}`], ["Basis of the model's error", accuracy.model.basis]];
}

async function start() {
  const job = await api.job(id);
  showHead(job);
  if (job.state !== "succeeded") throw new Error(`There is a report when the job has succeeded; it is ${job.state}.`);
  showSheet(id, /** @type {Job & { notes?: string | null }} */ (job).notes ?? "");
  const isSweep = job.kind === "sweep";
  const [result, input, kinds, gearData] = await Promise.all([isSweep ? api.resultWithoutRows(id) : api.result(id), api.input(id), api.kinds(), gearDataOf(id)]);
  const shafts = (await drawPair(input))?.shafts ?? null;
  if (isSweep) {
    fillWarnings(byId("warnings"), result.warnings);
    show(byId("warned"), result.warnings.length > 0);
    if (gearData) showGearData(gearData);
    showInputs(input, kinds);
    await showSweep({ id, job, input, result });
    return ready();
  }
  const catalogue = result.response ? (await api.catalogue(id)).items : [];
  fillRows(bodyOf(byId("headline")), headlines(result).map(([name, value, unit, note]) => [name, el("strong", {}, `${value} ${unit}`.trim()), el("span", {}, ...[note].flat())]));
  show(byId("summary"));
  fillWarnings(byId("warnings"), result.warnings);
  show(byId("warned"), result.warnings.length > 0);
  if (gearData) showGearData(gearData);
  showResults(result, input);
  showShaftsBlock(result, shafts);
  showInputs(input, kinds);
  if (result.response?.natural_modes?.length) {
    fillRows(byId("modes-table").tBodies[0], modeRows(result.response, input));
    show(byId("modes"));
  }
  fillValues(byId("numerics-values"), [
    ["Error of the RMS values, estimated", typeof result.response?.error_estimate === "number" ? number(result.response.error_estimate, 2) : null],
    ...modelError(result.accuracy ?? null),
    ["Error asked for", result.response ? number(input.analysis?.accuracy, 2) : null],
    ["Time", number(Object.values(result.numerics.wall_ms).reduce((sum, time) => sum + time, 0), 3), "ms"],
    ...numericsValues({ job: null, ...result }),
  ]);
  show(byId("numerics"));
  await showPlots({ id, job, result, input, catalogue, gearData }, shafts);
  ready();
}

function ready() {
  byId("print").disabled = false;
  byId("report").dataset.ready = "true";
}

byId("print").addEventListener("click", () => window.print());
start().catch((error) => notify(byId("notice"), error));
