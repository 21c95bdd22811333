// Follows all jobs: one stream of server-sent events (a stream per job would soon use up the few connections that a
// browser opens to one host), and reading again and again where that is refused or does not come through. Nothing is
// followed while the page is hidden.

const POLL_MS = 2000;
/** A stream without its first event for this long is taken to be blocked on the way. */
const SILENCE_MS = 4000;
/** Time until a refused stream is requested again. */
const RETRY_MS = 30_000;

/**
 * Calls `onReload` when everything is to be read (at first, after each gap, and again and again without a stream),
 * `onJob` with each job that changed, `onDeleted` with the id of one that is gone, `onMode` with "live", "polling" or
 * "lost". Returns a function that stops it.
 * @param {{ kind?: string, label?: string }} filter
 * @param {{
 *   onReload: () => Promise<unknown> | void,
 *   onJob: (job: Job) => void,
 *   onDeleted: (id: string) => void,
 *   onMode?: (mode: "live" | "polling" | "lost") => void,
 * }} listeners
 */
export function followJobs({ kind, label }, { onReload, onJob, onDeleted, onMode = () => {} }) {
  const given = /** @type {[string, string][]} */ (Object.entries({ kind, label }).filter(([, value]) => value));
  const url = `/api/v1/jobs/events${given.length ? `?${new URLSearchParams(given)}` : ""}`;
  let stopped = false;
  /** @type {EventSource | null} */
  let source = null;
  let isPolling = false;
  let polls = 0;
  /** @type {Record<"poll" | "silence" | "retry", number | undefined>} */
  const timers = { poll: undefined, silence: undefined, retry: undefined };

  function close() {
    source?.close();
    source = null;
    isPolling = false;
    for (const timer of Object.values(timers)) clearTimeout(timer);
  }

  /** Reads everything, and again some time after each answer. */
  async function poll() {
    clearTimeout(timers.poll);
    onMode("polling");
    const turn = (polls += 1);
    await onReload();
    if (isPolling && turn === polls) timers.poll = setTimeout(poll, POLL_MS);
  }

  function startPolling() {
    isPolling = true;
    poll();
  }

  function open() {
    close();
    if (stopped || document.hidden) return;
    if (!window.EventSource) {
      startPolling();
      return;
    }
    const stream = new EventSource(url);
    source = stream;
    timers.silence = setTimeout(startPolling, SILENCE_MS);
    stream.addEventListener("reload", () => {
      clearTimeout(timers.silence);
      clearTimeout(timers.poll);
      isPolling = false;
      onMode("live");
      onReload();
    });
    for (const name of ["state", "progress", "done"]) stream.addEventListener(name, (event) => onJob(JSON.parse(event.data)));
    stream.addEventListener("deleted", (event) => onDeleted(JSON.parse(event.data).id));
    stream.addEventListener("error", () => {
      if (source !== stream) return;
      if (stream.readyState === EventSource.CLOSED) {
        close();
        startPolling();
        timers.retry = setTimeout(open, RETRY_MS);
      } else {
        // The browser connects again by itself.
        clearTimeout(timers.silence);
        onMode("lost");
      }
    });
  }

  document.addEventListener("visibilitychange", open);
  window.addEventListener("pagehide", close);
  window.addEventListener("pageshow", (event) => event.persisted && open());
  open();
  return () => {
    stopped = true;
    close();
    document.removeEventListener("visibilitychange", open);
  };
}
