// A stream of server-sent events with a way around everything between it and the page: reading again and again where
// the stream is refused, or held back on the way (by a proxy that collects what it passes on), and saying when the
// connection is lost.

/** A stream without its first event for this long is held back on the way. */
const SILENCE_MS = 4000;
/** An open stream without an event for this long is compared with what can be read. */
const STALL_MS = 10_000;
/** Time until a refused stream is requested again. */
const RETRY_MS = 30_000;

/** How a page gets its news. @typedef {"live" | "polling" | "lost"} StreamMode */

/**
 * Follows a stream. The functions of `events` are called with its events by name; the first event must come at once.
 * `read` reads what the stream would tell, at each turn of polling; it says whether that is news, and throws when the
 * service is not reached.
 * @param {{
 *   url: string,
 *   events: Record<string, (data: any) => void>,
 *   read: () => Promise<boolean | void>,
 *   pollMs: number,
 *   checksStalls?: boolean,
 *   onMode?: (mode: StreamMode) => void,
 * }} options `checksStalls`: whether `read` is called on an open stream that is silent, to compare
 */
export function followStream({ url, events, read, pollMs, checksStalls = false, onMode = () => {} }) {
  let isStopped = false;
  /** @type {EventSource | null} */
  let source = null;
  let isPolling = false;
  let turns = 0;
  /** @type {Record<"poll" | "silence" | "stall" | "retry", number | undefined>} */
  const timers = { poll: undefined, silence: undefined, stall: undefined, retry: undefined };

  function close() {
    source?.close();
    source = null;
    isPolling = false;
    turns += 1;
    for (const timer of Object.values(timers)) clearTimeout(timer);
  }

  /** Reads, and again some time after each answer. */
  async function poll() {
    clearTimeout(timers.poll);
    const turn = (turns += 1);
    /** @type {StreamMode} */
    let mode = "polling";
    try {
      await read();
    } catch {
      mode = "lost";
    }
    if (!isPolling || turn !== turns) return;
    onMode(mode);
    timers.poll = setTimeout(poll, pollMs);
  }

  function startPolling() {
    if (isPolling) return;
    isPolling = true;
    poll();
  }

  /** An event has come: the stream is not held back. */
  function isAlive() {
    clearTimeout(timers.silence);
    clearTimeout(timers.poll);
    isPolling = false;
    onMode("live");
    if (checksStalls) watchForStall();
  }

  function watchForStall() {
    clearTimeout(timers.stall);
    timers.stall = setTimeout(async () => {
      const turn = turns;
      let isNews = false;
      try {
        isNews = (await read()) === true;
      } catch {
        isNews = true;
      }
      if (isStopped || isPolling || turn !== turns) return;
      if (isNews) startPolling();
      else watchForStall();
    }, STALL_MS);
  }

  function open() {
    close();
    if (isStopped) return;
    if (!window.EventSource) {
      startPolling();
      return;
    }
    const stream = new EventSource(url);
    source = stream;
    timers.silence = setTimeout(startPolling, SILENCE_MS);
    for (const [name, take] of Object.entries(events)) {
      stream.addEventListener(name, (event) => {
        if (source !== stream) return;
        isAlive();
        take(event.data ? JSON.parse(event.data) : null);
      });
    }
    stream.addEventListener("error", () => {
      if (source !== stream) return;
      clearTimeout(timers.silence);
      clearTimeout(timers.stall);
      if (stream.readyState === EventSource.CLOSED) {
        close();
        startPolling();
        timers.retry = setTimeout(open, RETRY_MS);
      } else {
        // The browser connects again by itself; a stream that opens and stays silent is held back then, too.
        if (!isPolling) onMode("lost");
        stream.addEventListener("open", () => {
          clearTimeout(timers.silence);
          timers.silence = setTimeout(startPolling, SILENCE_MS);
        }, { once: true });
      }
    });
  }

  open();
  return {
    open,
    close,
    stop() {
      isStopped = true;
      close();
    },
  };
}
