// The state of a job as badge and text.

import { el } from "./dom.js";
import { percent } from "./format.js";

/** @param {Job} job */
export const stateBadge = (job) => el("span", { class: `badge ${job.state}` }, job.state);

/** Stage and progress, beside the state's name. @param {Job} job */
export function describeState(job) {
  if (job.cancel_requested_at && (job.state === "running" || job.state === "queued")) return "canceling …";
  if (job.state === "running") return [job.stage, percent(job.progress)].filter(Boolean).join(", ");
  return "";
}
