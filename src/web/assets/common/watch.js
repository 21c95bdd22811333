// Follows a live job: server-sent events, and asking again and again where they do not come through.

import * as api from "./api.js";

const POLL_MS = 1000;

/**
 * Calls `onJob` with each new state of the job until it has ended. Returns a function that stops it.
 * @param {string} id
 * @param {(job: Job) => void} onJob
 */
export function watchJob(id, onJob) {
  let stopped = false;
  /** @type {EventSource | null} */
  let source = null;
  /** @type {number | undefined} */
  let timer;

  function stop() {
    stopped = true;
    source?.close();
    clearTimeout(timer);
  }

  function take(job) {
    if (stopped) return;
    if (api.isEnded(job)) stop();
    onJob(job);
  }

  async function ask() {
    try {
      take(await api.job(id));
    } catch (error) {
      if (error instanceof api.Problem && error.status === 404) stop();
    }
    if (!stopped) timer = setTimeout(ask, POLL_MS);
  }

  function listen() {
    const stream = new EventSource(`/api/v1/jobs/${encodeURIComponent(id)}/events`);
    // The data of every event is the whole job.
    for (const name of ["state", "progress", "done"]) stream.addEventListener(name, (event) => take(JSON.parse(event.data)));
    source = stream;
    stream.addEventListener("error", () => {
      // The browser reconnects by itself unless the server refused.
      if (stopped || stream.readyState !== EventSource.CLOSED) return;
      ask();
    });
  }

  if (window.EventSource) listen();
  else ask();
  return stop;
}
