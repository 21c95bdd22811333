// The time that a running job still takes, measured by its progress while the page is open.

/** Time over which the rate is measured, ms: the rest of a job goes on as its last part did. */
const WINDOW_MS = 60_000;
/** Least time and progress over which a rate means something. */
const LEAST_MS = 4000;
const LEAST_PROGRESS = 0.005;

/** Measures the rate of a job's progress. */
export class Remaining {
  constructor() {
    /** Progress of this attempt by time. @type {{ at: number, progress: number }[]} */
    this.seen = [];
    /** @type {number | null} */
    this.attempt = null;
  }

  /** Takes up a state of the job. @param {Job} job @param {number} now ms */
  note(job, now) {
    const progress = job.progress ?? 0;
    const last = this.seen.at(-1);
    // Another attempt begins anew; so does what was set back.
    if (job.attempt !== this.attempt || job.state !== "running" || (last && progress < last.progress)) this.seen = [];
    this.attempt = job.attempt;
    if (job.state !== "running" || this.seen.at(-1)?.progress === progress) return;
    this.seen.push({ at: now, progress });
    while (this.seen.length > 2 && now - this.seen[1].at > WINDOW_MS) this.seen.shift();
  }

  /** Milliseconds until the job ends; null while that is not known. @param {number} now ms */
  at(now) {
    const [first] = this.seen;
    const last = this.seen.at(-1);
    if (!first || !last || last.at - first.at < LEAST_MS || last.progress - first.progress < LEAST_PROGRESS) return null;
    const rate = (last.progress - first.progress) / (last.at - first.at);
    const left = (1 - last.progress) / rate - (now - last.at);
    // Progress that stands still for longer than it should take says nothing.
    return left > 0 ? left : null;
  }
}

/** A time to come as people say it. @param {number} ms */
export function leftText(ms) {
  const seconds = ms / 1000;
  if (seconds < 10) return "a few seconds left";
  if (seconds < 90) return `about ${Math.round(seconds / 5) * 5} s left`;
  if (seconds < 90 * 60) return `about ${Math.round(seconds / 60)} min left`;
  return `about ${(seconds / 3600).toFixed(seconds < 36_000 ? 1 : 0)} h left`;
}
