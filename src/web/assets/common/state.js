// How a job's state is shown.

import { el } from "./dom.js";
import { percent } from "./format.js";

export const stateBadge = (job) => el("span", { class: `badge ${job.state}` }, job.state);

/** What goes on beyond the state's name. */
export function describeState(job) {
  if (job.cancel_requested_at && (job.state === "running" || job.state === "queued")) return "canceling …";
  if (job.state === "running") return [job.stage, percent(job.progress)].filter(Boolean).join(", ");
  return "";
}
