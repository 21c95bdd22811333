// Follows all jobs by one stream of server-sent events (a stream per job would soon use up the few connections that a
// browser opens to one host), or by reading again and again. Nothing is followed while the page is hidden.

import { followStream } from "./stream.js";

const POLL_MS = 2000;

/**
 * Calls `onReload` when everything is to be read (at first, after each gap, and again and again without a stream),
 * `onJob` with each job that changed, `onDeleted` with the id of one that is gone, `onMode` with "live", "polling" or
 * "lost". Returns a function that stops it.
 * @param {{ kind?: string, label?: string }} filter
 * @param {{
 *   onReload: () => Promise<unknown> | void,
 *   onJob: (job: Job) => void,
 *   onDeleted: (id: string) => void,
 *   onMode?: (mode: import("./stream.js").StreamMode) => void,
 * }} listeners
 */
export function followJobs({ kind, label }, { onReload, onJob, onDeleted, onMode }) {
  const given = /** @type {[string, string][]} */ (Object.entries({ kind, label }).filter(([, value]) => value));
  const stream = followStream({
    url: `/api/v1/jobs/events${given.length ? `?${new URLSearchParams(given)}` : ""}`,
    events: { reload: () => { onReload(); }, state: onJob, progress: onJob, done: onJob, deleted: ({ id }) => onDeleted(id) },
    read: async () => { await onReload(); },
    pollMs: POLL_MS,
    onMode,
  });
  const onVisibility = () => (document.hidden ? stream.close() : stream.open());
  document.addEventListener("visibilitychange", onVisibility);
  window.addEventListener("pagehide", stream.close);
  window.addEventListener("pageshow", (event) => event.persisted && onVisibility());
  if (document.hidden) stream.close();
  return () => {
    stream.stop();
    document.removeEventListener("visibilitychange", onVisibility);
  };
}
