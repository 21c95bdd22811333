// Numerics of the result: method, accuracy reached, time of the stages, reused stages.

import { byId, el, fillValues, show } from "../common/dom.js";
import { number } from "../common/format.js";
import { scalarAt } from "../common/scalars.js";
import { METHODS } from "./words.js";

/** Stages with the names of their times. @type {[keyof Numerics["wall_ms"], string][]} */
const STAGES = [["geometry", "Geometry"], ["mesh", "Tooth contact"], ["impact", "Mesh-in impact"], ["response", "Vibration"]];
const REUSED = { result: "the whole result of an equal job", mesh: "tooth contact", finite_elements: "finite elements", points: "points of a sweep" };
/** Shares of the time too small to be seen in the bar. */
const VISIBLE = 0.004;

/** @param {JobContext} context */
export function showNumerics({ job, input, result: { numerics, response, mesh } }) {
  if (!numerics) return;
  showAccuracy(response, input);
  showTimes(numerics.wall_ms ?? {});
  fillValues(byId("numerics-values"), numericsValues({ job, numerics, response, mesh }));
  show(byId("numerics"));
}

/** @param {ResponseResult | null | undefined} response @param {JobInput} input */
function showAccuracy(response, input) {
  const [reached, asked] = [response?.error_estimate, input?.analysis?.accuracy];
  const line = byId("accuracy");
  const known = typeof reached === "number" && typeof asked === "number";
  show(line, known);
  if (!known) return;
  const good = reached <= asked;
  line.replaceChildren(
    el("strong", { class: good ? "better" : "worse" }, good ? "✓ Accuracy reached: " : "✗ Accuracy not reached: "),
    `estimated relative error of the RMS values ${number(reached, 2)}, asked for ${number(asked, 2)}.`,
  );
}

/** @param {Partial<Numerics["wall_ms"]>} wall */
function showTimes(wall) {
  const total = STAGES.reduce((sum, [name]) => sum + (wall[name] ?? 0), 0);
  const box = byId("times");
  show(box, total > 0);
  if (box.hidden) return;
  const bar = el("div", { class: "times-bar" });
  bar.setAttribute("aria-hidden", "true");
  const keys = STAGES.filter(([name]) => wall[name]).map(([name, label], index) => {
    const part = el("span", { class: `stage-${index + 1}` });
    part.style.flexGrow = String(Math.max((wall[name] ?? 0) / total, VISIBLE));
    bar.append(part);
    return el("li", { class: "key" }, el("span", { class: `swatch stage-${index + 1}` }), `${label} ${number(wall[name], 3)} ms`);
  });
  box.replaceChildren(bar, el("ul", { class: "times-keys" }, ...keys, el("li", { class: "muted" }, `${number(total, 3)} ms in all`)));
}

/** @param {Pick<JobResult, "numerics" | "response" | "mesh"> & { job: Job | null }} solved @returns {ValueRow[]} */
export function numericsValues({ job, numerics, response, mesh }) {
  const convergence = mesh?.convergence;
  const { reused = [], degrees_of_freedom: freedom } = numerics;
  const halves = freedom === 6 ? "6 of 12 (the halves mirror each other)" : freedom === 12 ? "12 of 12" : freedom ? number(freedom) : null;
  const states = freedom ? `${number(2 * freedom)} of 24` : null;
  /** @param {number | null | undefined} shown */
  const count = (shown) => (shown && shown > 0 ? number(shown, 9) : null);
  /** @param {number | null | undefined} error */
  const small = (error) => (typeof error === "number" ? number(error, 2) : null);
  /** A row by the scalar's label and unit. @type {(pointer: string, shown: Child) => ValueRow} */
  const row = (pointer, shown) => [scalarAt(pointer).label, shown, scalarAt(pointer).unit, scalarAt(pointer)];
  return [
    ["Method", response ? (METHODS[response.method] ?? response.method) : null, "", scalarAt("/response/method")],
    row("/numerics/degrees_of_freedom", halves),
    ["States of the equations", states, "", scalarAt("/numerics/degrees_of_freedom")],
    [scalarAt("/response/averaged_mesh_periods").label, count(response?.averaged_mesh_periods), "", scalarAt("/response/averaged_mesh_periods")],
    row("/numerics/steps", count(numerics.steps)),
    row("/numerics/rejected_steps", count(numerics.rejected_steps)),
    row("/numerics/force_evaluations", count(numerics.force_evaluations)),
    ["Contact analysis: positions per mesh period, slices", convergence ? `${number(convergence.positions)}, ${number(convergence.slices)}` : null, "", scalarAt("/mesh/convergence/positions")],
    row("/mesh/convergence/position_error_percent", small(convergence?.position_error_percent)),
    ["Contact force: levels, phases tabulated", mesh?.contact_force ? `${number(mesh.contact_force.levels)}, ${number(mesh.contact_force.phases)}` : null, "", scalarAt("/mesh/contact_force/levels")],
    row("/mesh/contact_force/error_percent", small(mesh?.contact_force?.error_percent)),
    row("/mesh/convergence/slice_error_percent", small(convergence?.slice_error_percent)),
    row("/response/energy_balance_residual", small(response?.energy_balance_residual)),
    ["Reused", reused.length ? reused.map((name) => REUSED[name] ?? name).join(", ") : "nothing", "", scalarAt("/numerics/wall_ms/mesh")],
    row("/numerics/solver_version", numerics.solver_version),
    ["Input hash", job?.input_hash ? el("code", { class: "hash" }, job.input_hash) : null],
    ...(numerics.not_finite ?? []).map(({ pointer, reason }) => /** @type {ValueRow} */ ([`Not finite: ${pointer}`, reason])),
  ];
}
