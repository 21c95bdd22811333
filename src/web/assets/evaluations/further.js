// What is asked of the best design next: a curve over the torque beside that of the input, and tolerances.

import * as api from "../common/api.js";
import { byId, notify } from "../common/dom.js";
import { asKind } from "../design/evaluations.js";

/** Points of the curves, and their ends as parts of the least and the largest torque. */
const POINTS = 21;
const ENDS = [0.5, 1.25];
/** Longest name that a document may have. */
const NAME_LENGTH = 200;

/** @typedef {{ id: string, name: string, input: JobInput, position: number }} Best */

const named = (name, what) => `${name.slice(0, NAME_LENGTH - what.length - 2)}: ${what}`;

/** @param {HTMLButtonElement} button @param {() => Promise<string>} act gives the address of the page to go to */
async function goTo(button, act) {
  button.disabled = true;
  try {
    window.location.assign(await act());
  } catch (error) {
    notify(byId("notice"), error);
    button.disabled = false;
  }
}

/**
 * Sweeps the torque for the input and for the best design, and compares both.
 * @param {HTMLButtonElement} button @param {Best} best
 */
export function compareOverTorque(button, { id, name, input, position }) {
  const given = (input.operating_points ?? []).map(({ pinion_torque_nm: torque }) => torque).filter((torque) => typeof torque === "number");
  const torques = given.length ? given.map(Number) : [input.operation.pinion_torque_nm];
  const axis = { pointer: "/operation/pinion_torque_nm", from: ENDS[0] * Math.min(...torques), to: ENDS[1] * Math.max(...torques), points: POINTS };
  return goTo(button, async () => {
    const jobs = [];
    for (const [row, what] of [[0, "input over the torque"], [position, "best over the torque"]]) {
      const document = await api.pointInput(id, Number(row));
      const job = await api.submit({ ...document, kind: "sweep", name: named(name, String(what)), axes: [axis] }, api.newKey());
      jobs.push(job.id);
    }
    return `/compare?jobs=${jobs.map(encodeURIComponent).join(",")}`;
  });
}

/**
 * Studies the tolerances of the best design: those of the document, or usual ones.
 * @param {HTMLButtonElement} button @param {Best} best
 */
export function studyTolerances(button, { id, name, input, position }) {
  return goTo(button, async () => {
    const study = asKind(await api.pointInput(id, position), "tolerance");
    const { operating_points: points, tolerances, correlations, objectives } = input;
    const own = tolerances?.length ? { tolerances, ...(correlations?.length ? { correlations } : {}) } : {};
    const measures = objectives.map(({ measure, halves, over }) => ({ measure, halves, over }));
    const at = points?.length ? { operating_points: points } : {};
    const job = await api.submit({ ...study, ...own, ...at, measures, name: named(name, "tolerances of the best") }, api.newKey());
    return `/jobs/${encodeURIComponent(job.id)}`;
  });
}
