// Reads a compared job: the job, its document and its result.

import * as api from "../common/api.js";
import { Grid } from "../sweep/axes.js";
import { SweepData } from "../sweep/data.js";
import { columnsOf, QUANTITIES } from "../sweep/quantities.js";

/**
 * Reads everything about a job as it stands; `known` is an earlier result of this function.
 * @param {string} id
 * @param {LoadedJob} [known]
 * @returns {Promise<LoadedJob>}
 *
 * @typedef {Pick<ComparedJob, "id" | "job" | "input" | "result" | "channels" | "sweep">} LoadedJob
 */
export async function load(id, known) {
  let job;
  try {
    job = await api.job(id);
  } catch (error) {
    if (error instanceof api.Problem && error.status === 404) return { id, job: null };
    throw error;
  }
  const same = known?.job && known.job.revision === job.revision ? known : null;
  if (same) return same;
  const input = known?.input ?? (await api.input(id));
  // The solved points of a sweep are kept when it fails or is canceled.
  if (job.kind === "sweep" && api.isEnded(job)) return { id, job, input, ...(await sweepOf(id, input)) };
  if (job.state !== "succeeded") return { id, job, input };
  const [result, channels] = await Promise.all([api.result(id), job.kind === "response" ? api.catalogue(id).then(({ items }) => items) : []]);
  return { id, job, input, result, channels };
}

/** The rows of a sweep, by columns; nothing when it has none. @param {string} id @param {JobInput} input */
async function sweepOf(id, input) {
  const grid = new Grid(input);
  const data = new SweepData(id, grid.total);
  await data.require([...QUANTITIES.flatMap(columnsOf), "contact"]);
  await data.refresh();
  return data.n > 0 ? { sweep: { grid, data } } : {};
}
