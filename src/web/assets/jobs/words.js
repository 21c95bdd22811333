// Names of jobs, counts and durations as text.

import { seconds } from "../common/format.js";

/** A job's name; without one its kind and the end of its id. @param {Job} job */
export const nameOf = (job) => job.name || `Unnamed ${job.kind} …${job.id.slice(-6)}`;

/** @param {number} number @param {string} [noun] */
export const count = (number, noun = "job") => `${number} ${noun}${number === 1 ? "" : "s"}`;

/** Seconds that a job has run for, or null. @param {Job} job */
export function durationOf(job, now = Date.now()) {
  if (!job.started_at) return null;
  if (job.ended_at) return seconds(job.started_at, job.ended_at);
  return job.state === "running" ? Math.max(0, (now - Date.parse(job.started_at)) / 1000) : null;
}

/** A duration in seconds, in at most two units. @param {number} span */
export function duration(span) {
  if (span < 0.0995) return `${Math.max(1, Math.round(span * 1000))} ms`;
  if (span < 9.95) return `${span.toFixed(1)} s`;
  const whole = Math.round(span);
  const [days, hours, minutes, rest] = [Math.floor(whole / 86_400), Math.floor(whole / 3600) % 24, Math.floor(whole / 60) % 60, whole % 60];
  if (days) return `${days} d ${hours} h`;
  if (hours) return `${hours} h ${minutes} min`;
  return minutes ? `${minutes} min ${rest} s` : `${rest} s`;
}
