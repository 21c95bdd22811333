// What is known of a compared job: the job, its document, and what it found.

import * as api from "../common/api.js";

/** Points of a sweep that are read at most; they come in pages. */
const MOST_POINTS = 20_000;
const PAGE = 5000;

/** Reads everything about a job as it stands; `known` is what was read before. */
export async function load(id, known) {
  let job;
  try {
    job = await api.job(id);
  } catch (error) {
    if (error.status === 404) return { id, job: null };
    throw error;
  }
  const same = known?.job && known.job.revision === job.revision ? known : null;
  if (same) return same;
  const input = known?.input ?? (await api.input(id));
  if (job.state !== "succeeded") return { id, job, input };
  if (job.kind === "sweep") return { id, job, input, ...(await pointsOf(id)) };
  const [result, channels] = await Promise.all([api.result(id), job.kind === "response" ? api.catalogue(id).then(({ items }) => items) : []]);
  return { id, job, input, result, channels };
}

async function pointsOf(id) {
  const points = [];
  let from = 0;
  let total = 0;
  while (from !== null && points.length < MOST_POINTS) {
    const page = await api.points(id, { from, limit: PAGE });
    points.push(...page.items.map(({ point }) => point));
    total = page.n_points;
    from = page.next_position;
  }
  return { points, isCut: points.length < total };
}

export const isSolved = ({ result, points }) => Boolean(result || points);
