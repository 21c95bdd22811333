// The outcome of an optimisation: verdict, input and best design side by side, gain by operating point, course of the
// search, the best evaluations.

import { bodyOf, byId, el, fillRows, fillValues, show, showFigureOf } from "../common/dom.js";
import { number, sentence, shownUnit } from "../common/format.js";
import { bars, draw, line, points } from "../common/plots.js";
import { drawCoordinates } from "./coordinates.js";
import { compareOverTorque, studyTolerances } from "./further.js";
import { inputLabel, openRow, pointText } from "./rows.js";

/** Phases whose rows are designs by themselves, not a design with deviations or at another speed. */
const OF_DESIGNS = ["input", "sample", "search", "polish", "nearest", "confirm", "flatness"];
/** Rows of the table of evaluations. */
const ROWS = 20;

/** @param {{ id: string, job: Job, result: JobResult, input: JobInput }} context */
export async function showOptimisation({ id, job, result, input }) {
  const found = result.optimise;
  if (!found) return;
  show(byId("optimise"));
  byId("optimise-verdict").textContent = verdict(found);
  byId("optimise-limits").textContent = `${limits(found)}${nearJump(found)}`;
  fillRows(bodyOf(byId("optimise-values")), input.variables.map((variable) => variableRow(variable, found)));
  fillRows(bodyOf(byId("optimise-objectives")), found.objectives.map((objective) => [
    `${sentence(objective.label)}${objective.per_point.length > 1 ? `, ${objective.over}` : ""}${objective.relative_to ? ", relative to the input" : ""}`, number(objective.input), number(objective.best), number(objective.gain_percent, 3), unitOf(objective),
  ]));
  showRobust(found);
  showRows(found, input);
  const { numerics } = found;
  fillValues(byId("optimise-numerics"), [
    ["Evaluations", number(numerics.evaluations)],
    ["Infeasible", number(numerics.infeasible)],
    ["Failed", number(numerics.failed)],
    ["Method", numerics.method === "cma_es" ? "CMA-ES" : "Nelder–Mead"],
    ["Ended by", ENDS[numerics.stopped_by] ?? numerics.stopped_by],
    ["Reached of all possible improvement (hypervolume)", found.history.hypervolume?.length ? `${number(100 * (found.history.hypervolume.at(-1) ?? 0), 3)} %` : null],
    ["Seed", number(numerics.seed)],
  ]);
  byId("optimise-csv").href = `/api/v1/jobs/${encodeURIComponent(id)}/points?decimal=point`;
  const button = byId("optimise-open");
  show(button, Boolean(found.best));
  button.addEventListener("click", () => openRow(button, { id, name: job.name ?? "Optimisation", position: found.best?.position ?? 0, what: "best design" }));
  const name = job.name ?? "Optimisation";
  const best = { id, name, input, position: found.best?.position ?? 0 };
  const [torque, tolerances] = [byId("optimise-torque"), byId("optimise-tolerances")];
  show(torque, Boolean(found.best));
  show(tolerances, Boolean(found.best));
  torque.addEventListener("click", () => compareOverTorque(torque, best));
  tolerances.addEventListener("click", () => studyTolerances(tolerances, best));
  await Promise.all([drawGain(found), drawHistory(found), drawFront(found, id), drawCoordinates(found, input)]);
}

/** @type {Record<string, string>} */
const ENDS = {
  budget: "the budget: more evaluations may find more",
  time: "the time limit: more time may find more",
  tolerance: "tolerance: further runs found nothing better",
};

/** Unit of an objective: none of a ratio. @param {{ unit: string, relative_to?: string | null }} objective */
const unitOf = ({ unit, relative_to: relative }) => (relative ? "" : shownUnit(unit));

/** @param {Optimisation} found */
function nearJump({ neighbours = [] }) {
  const jumps = neighbours.filter(({ jump }) => jump).map(({ speed_percent: percent }) => `${percent > 0 ? "+" : "−"}${Math.abs(percent)} %`);
  return jumps.length ? ` A jump is near: the vibration changes by more than a half up to a speed ${jumps.join(" and ")} away.` : "";
}

/** The outcome in a sentence. @param {Optimisation} found */
function verdict({ verdict: word, objectives: [objective] }) {
  if (word !== "improved" || typeof objective?.gain_percent !== "number") return `${sentence(word)}.`;
  const gains = objective.per_point.filter(({ gain_percent: gain }) => typeof gain === "number");
  const least = gains.length > 1 ? gains.reduce((a, b) => (Number(a.gain_percent) <= Number(b.gain_percent) ? a : b)) : null;
  const rest = least ? ` The least gain is ${number(least.gain_percent, 3)} %, at ${pointText(least)}.` : "";
  return `Better by ${number(objective.gain_percent, 3)} %: ${objective.label} ${number(objective.best, 4)} instead of ${number(objective.input, 4)} ${unitOf(objective)}${objective.relative_to ? "of the input’s at the worst point" : ""}.${rest}`;
}

/** What limits the best design. @param {Optimisation} found */
function limits({ active, best }) {
  if (!best) return "";
  if (active.length === 0) return "No bound or constraint limits the best design.";
  return `Limited by ${active.map(({ pointer, at, constraint }) => (pointer ? `${inputLabel(pointer)} (${at})` : `${constraint}`)).join("; ")}.`;
}

/** @param {{ pointer: string, from: number, to: number }} variable @param {Optimisation} found */
function variableRow({ pointer, from, to }, { input, best, flatness }) {
  const flat = flatness.find((one) => one.pointer === pointer);
  const range = flat?.range_within_2_percent;
  const rise = flat?.rise_at_ends_percent?.map((percent) => (typeof percent === "number" ? `${number(Math.max(percent, 0), 2)} %` : "–"));
  return [inputLabel(pointer), number(input.values[pointer]), number(best?.values[pointer]), number(from), number(to), range ? `${number(range[0], 4)} to ${number(range[1], 4)}` : "–", rise ? rise.join(", ") : "–"];
}

/** @param {Optimisation} found */
function showRobust({ robust }) {
  show(byId("optimise-robust"), Boolean(robust));
  if (!robust) return;
  const row = (name, statistics) => [name, ...["mean", "p50", "p90", "p95", "max"].map((word) => number(statistics?.[word]))];
  fillRows(bodyOf(byId("optimise-robust-table")), [row("Input", robust.input), ...(robust.nominal_best ? [row("Best without deviations", robust.nominal_best)] : []), row("Best", robust.best)]);
  byId("optimise-robust-note").textContent = `${number(robust.candidates.length)} candidates compared by ${robust.measure}; these numbers are from ${number(robust.sample)} other points.`;
}

/** The best evaluations. @param {Optimisation} found @param {JobInput} input */
function showRows(found, input) {
  const table = byId("optimise-rows");
  const head = ["Evaluation", ...input.variables.map(({ pointer }) => inputLabel(pointer)), ...found.objectives.map((objective) => `${objective.label}, ${unitOf(objective)}`)];
  table.tHead?.replaceChildren(el("tr", {}, ...head.map((text) => el("th", { scope: "col" }, text))));
  const sign = found.objectives[0]?.goal === "maximise" ? -1 : 1;
  const feasible = found.points.map((row, position) => ({ row, position })).filter(({ row }) => row.violation === 0 && row.objectives && OF_DESIGNS.includes(String(row.phase)));
  feasible.sort((a, b) => sign * (Number(a.row.objectives?.[0]) - Number(b.row.objectives?.[0])));
  fillRows(bodyOf(table), feasible.slice(0, ROWS).map(({ row, position }) => [`${position + 1} (${row.phase})`, ...row.values.map((value) => number(value)), ...(row.objectives ?? []).map((value) => number(value))]));
}

/** @param {Optimisation} found */
async function drawGain({ objectives: [objective] }) {
  const box = byId("optimise-gain-plot");
  showFigureOf(box, Boolean(objective?.per_point.length));
  if (!objective?.per_point.length) return;
  const at = objective.per_point.map(pointText);
  const y = { label: sentence(objective.label), unit: shownUnit(objective.unit) };
  await draw(box, [bars(at, objective.per_point.map(({ input }) => input), "input"), bars(at, objective.per_point.map(({ best }) => best), "best")], { x: "Operating point", y, fromZero: true });
}

/** @param {Optimisation} found */
async function drawHistory({ history, objectives: [objective] }) {
  await draw(byId("optimise-history-plot"), [line(history.evaluations, history.best)], { x: "Evaluations", y: { label: sentence(objective.label), unit: unitOf(objective) } });
}

/** @param {Optimisation} found @param {string} id */
async function drawFront({ front = [], objectives: [first, second] }, id) {
  const box = byId("optimise-front-plot");
  showFigureOf(box, front.length > 0 && Boolean(second));
  if (front.length === 0 || !second) return;
  const of = (objective) => ({ label: sentence(objective.label), unit: unitOf(objective) });
  const click = async (event) => {
    const design = front[event.points[0].pointIndex];
    if (design) window.open(`/api/v1/jobs/${encodeURIComponent(id)}/points/${design.position}/input`);
  };
  await draw(box, [points(front.map(({ objectives }) => objectives[0]), front.map(({ objectives }) => objectives[1]))], { x: of(first), y: of(second), click });
}
