// Follows a live job: server-sent events, and asking again and again where they do not come through.

import * as api from "./api.js";

const POLL_MS = 1000;

/** Calls `onJob` with each new state of the job until it has ended. Returns a function that stops it. */
export function watchJob(id, onJob) {
  let stopped = false;
  let source = null;
  let timer = null;

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
      if (error.status === 404) stop();
    }
    if (!stopped) timer = setTimeout(ask, POLL_MS);
  }

  function listen() {
    source = new EventSource(`/api/v1/jobs/${encodeURIComponent(id)}/events`);
    // The data of every event is the whole job.
    for (const name of ["state", "progress", "done"]) source.addEventListener(name, (event) => take(JSON.parse(event.data)));
    source.addEventListener("error", () => {
      // The browser reconnects by itself unless the server refused.
      if (stopped || source.readyState !== EventSource.CLOSED) return;
      ask();
    });
  }

  if (window.EventSource) listen();
  else ask();
  return stop;
}
