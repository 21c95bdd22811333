// Extremes, jumps and ranges with two motions of a sweep, in sentences with a way to their points.

import { byId, el } from "../common/dom.js";
import { number, percent } from "../common/format.js";
import { valueText } from "./axes.js";
import { hysteresisAt, jumpsAt } from "./curves.js";
import { valueAt } from "./maps.js";
import { resonancesOf } from "./resonances.js";

/** Findings of one kind that are listed. */
const MOST = 6;
/** A peak this near to a crossing belongs to it. */
const NEAR = 0.03;

/**
 * @typedef {{ text: string, position?: number }} Finding
 * @param {SweepState} sweep
 * @param {SweepView} view
 * @param {(position: number) => void} select
 */
export function showFindings(sweep, view, select) {
  const { grid } = view;
  const items = findingsOf(sweep, view);
  byId("sweep-findings").replaceChildren(...items.map(({ text, position }) => {
    const button = position === undefined ? null : el("button", { type: "button", class: "quiet" }, "Show");
    button?.setAttribute("aria-label", `Show ${position === undefined ? "" : grid.describe(position)}`);
    if (position !== undefined) button?.addEventListener("click", () => select(position));
    return el("li", {}, el("span", {}, text), button);
  }));
}

/** @param {SweepState} sweep @param {SweepView} view @returns {Finding[]} */
export function findingsOf(sweep, view) {
  const items = [...extremes(sweep, view), ...ranges(sweep, view), ...jumps(sweep, view)];
  const failed = sweep.data.failed();
  if (failed.length) {
    const text = failed.length === 1 ? "One point has no response." : `${number(failed.length)} of ${number(sweep.data.n)} points have no response.`;
    items.push({ text, position: failed[0] });
  }
  return items;
}

/**
 * Greatest and least value of the quantity, and the resonance that a peak belongs to.
 * @param {SweepState} sweep
 * @param {SweepView} view
 * @returns {Finding[]}
 */
function extremes(sweep, view) {
  const { grid, quantity } = view;
  const value = valueAt(sweep, quantity, view.halves);
  /** @type {number | null} */
  let least = null;
  /** @type {number | null} */
  let greatest = null;
  for (let position = 0; position < grid.total; position += 1) {
    const at = value(position);
    if (Number.isNaN(at)) continue;
    if (least === null || at < value(least)) least = position;
    if (greatest === null || at > value(greatest)) greatest = position;
  }
  if (least === null || greatest === null || value(least) === value(greatest)) return [];
  /** @param {string} word @param {number} position */
  const tell = (word, position) => {
    const text = `${word} value: ${number(value(position), 4)}${quantity.unit ? ` ${quantity.unit}` : ""} at ${grid.describe(position)}`;
    return { text: `${text}${word === "Greatest" ? resonance(sweep, view, position) : ""}.`, position };
  };
  return [tell("Greatest", greatest), tell("Least", least)];
}

/** @param {SweepState} sweep @param {SweepView} view @param {number} position */
function resonance(sweep, view, position) {
  const { grid, quantity } = view;
  if (!quantity.name.includes("acceleration") && quantity.name !== "dynamic_factor") return "";
  const values = grid.axes[0].values;
  const line = grid.placeOf(position).second;
  /** @type {Span} */
  const ends = [values[grid.order[0]], values[grid.order[grid.order.length - 1]]];
  const speed = grid.valuesAt(position)[0];
  const near = resonancesOf(sweep.rest, { ...view, line }, ends).filter(({ at }) => Math.abs(at / speed - 1) < NEAR);
  if (!near.length) return "";
  const [{ order, mode, at }] = near.sort((a, b) => Math.abs(a.at - speed) - Math.abs(b.at - speed));
  return `, near the resonance of mesh order ${order} with “${mode.name}” (${number(mode.frequency_hz, 4)} Hz, ${number(at, 4)} r/min)`;
}

/** @param {SweepState} sweep @param {SweepView} view @returns {Finding[]} */
function ranges(sweep, view) {
  const { grid } = view;
  const axis = grid.axes[0];
  const all = hysteresisAt(sweep, view);
  /** @type {Finding[]} */
  const found = all.slice(0, MOST).map(({ from, to, differ, largest_rms_ratio: ratio }) => {
    const where = from === to ? `At ${valueText(axis, from)}` : `From ${valueText(axis, from)} to ${valueText(axis, to)}`;
    const much = ratio > 1.005 ? `, the stronger up to ${number(ratio, 3)} times the weaker` : "";
    return { text: `${where} two motions exist (they differ in ${differ.map((word) => (word === "rms" ? "RMS" : word)).join(", ")}${much}): which one runs depends on where the speed or load came from.`.replace("the speed or load", axis.label.toLowerCase()), position: placed(grid, axis, from, view.line, 0) };
  });
  if (all.length > MOST) found.push({ text: `${all.length - MOST} more ranges with two motions.` });
  return found;
}

/** @param {SweepState} sweep @param {SweepView} view @returns {Finding[]} */
function jumps(sweep, view) {
  const { grid } = view;
  const axis = grid.axes[0];
  const all = jumpsAt(sweep, view);
  /** @type {Finding[]} */
  const found = all.slice(0, MOST).map(({ branch, from, to, rms_before_m_s2: before, rms_after_m_s2: after }) => ({
    text: `On the way ${branch} the motion jumps between ${valueText(axis, from)} and ${valueText(axis, to)}: circumferential RMS from ${number(before, 4)} to ${number(after, 4)} m/s².`,
    position: placed(grid, axis, to, view.line, grid.branches.indexOf(branch)),
  }));
  if (all.length > MOST) found.push({ text: `${all.length - MOST} more jumps.` });
  return found;
}

/**
 * @param {SweepView["grid"]} grid
 * @param {import("./axes.js").Axis} axis
 * @param {number} value
 * @param {number} line
 * @param {number} branch
 */
function placed(grid, axis, value, line, branch) {
  const first = axis.values.indexOf(value);
  return first < 0 ? undefined : grid.at(first, line, branch);
}

/** The progress of the sweep. @param {SweepState} sweep @param {Job} job */
export function progressText(sweep, job) {
  const { n, total } = sweep.data;
  if (n === total) return total === 1 ? "One point." : `${number(total)} points.`;
  const state = { queued: "waiting", running: "more are coming", canceled: "canceled", failed: "stopped by a failure", succeeded: "reading" }[job.state];
  return `${number(n)} of ${number(total)} points solved (${percent(n / total)}); ${state}.`;
}
