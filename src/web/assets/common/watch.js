// Follows a live job, by its stream of server-sent events or by asking again and again.

import * as api from "./api.js";
import { followStream } from "./stream.js";

const POLL_MS = 1000;

/**
 * Calls `onJob` with each new state of the job until it has ended, `onMode` with the way in which the page gets them,
 * `onGone` when the job was deleted. Returns a function that stops it.
 * @param {string} id
 * @param {{
 *   onJob: (job: Job) => void,
 *   onMode?: (mode: import("./stream.js").StreamMode) => void,
 *   onGone?: (error: unknown) => void,
 * }} listeners
 */
export function watchJob(id, { onJob, onMode, onGone = () => {} }) {
  let isStopped = false;
  /** The last state that was told, as text. */
  let last = "";

  function stop() {
    isStopped = true;
    stream.stop();
  }

  /** Takes up a state of the job; whether it is news. @param {Job} job */
  function take(job) {
    const text = JSON.stringify([job.revision, job.progress]);
    const isNews = text !== last;
    last = text;
    if (isStopped) return false;
    if (api.isEnded(job)) stop();
    onJob(job);
    return isNews;
  }

  async function read() {
    try {
      return take(await api.job(id));
    } catch (error) {
      if (!(error instanceof api.Problem) || error.status !== 404) throw error;
      stop();
      onGone(error);
      return false;
    }
  }

  const stream = followStream({
    url: `/api/v1/jobs/${encodeURIComponent(id)}/events`,
    // The data of every event is the whole job.
    events: { state: take, progress: take, done: take },
    read,
    pollMs: POLL_MS,
    checksStalls: true,
    onMode: (mode) => isStopped || onMode?.(mode),
  });
  return stop;
}
