// The service itself: its workers, what each of them computes, what waits and why.

import * as api from "../common/api.js";
import { bodyOf, byId, el, notify, show } from "../common/dom.js";
import { age, percent } from "../common/format.js";
import { named, reasons } from "./words.js";

const PAUSE_MS = 2000;
/** Silence of a worker that is worth a word: a busy one is heard of every second, an idle one every five. */
const SILENT_S = 6.5;

const notice = byId("notice");
const rows = bodyOf(byId("workers"));
/** Names of the workers that were there at the last look; null before the first one. @type {Set<string> | null} */
let known = null;

/** @param {string} name @param {string} value */
const entry = (name, value) => el("div", {}, el("dt", {}, name), el("dd", {}, value));

/** @param {SystemState} system */
function fillService(system) {
  const { queue, workers } = system;
  byId("service").replaceChildren(
    entry("Version", system.version),
    entry("Calculation", system.solver_version),
    entry("Running since", new Date(system.started_at).toLocaleString()),
    entry("Jobs that wait", `${queue.depth} of at most ${queue.capacity}`),
    entry(queue.transport === "nats" ? "Threads of all workers" : "Jobs at once", `${workers.busy} of ${workers.total} busy`),
    entry("Sweeps, optimisations, tolerance studies", `${workers.sweeps_busy} of ${workers.sweeps_total} at once`),
  );
  show(byId("closing"), system.shutting_down);
  show(byId("unconnected"), queue.connected === false);
}

/** @param {Machine} machine @param {number} now */
function rowOf(machine, now) {
  const chunk = (/** @type {Chunk} */ { job, chunk: part, stage, fraction }) =>
    el("li", {}, el("a", { href: `/jobs/${job}` }, `…${job.slice(-6)}`), `, part ${part + 1}: ${stage || "begins"} ${percent(fraction)}`);
  const running = machine.running.length ? el("ul", {}, ...machine.running.map(chunk)) : "nothing";
  const isSilent = machine.silent_s > SILENT_S;
  const beat = isSilent
    ? el("span", { class: "silent" }, machine.lost ? `lost: silent for ${Math.round(machine.silent_s)} s` : `silent for ${Math.round(machine.silent_s)} s`)
    : age(machine.last_beat_at, now);
  return el(
    "tr",
    { class: machine.lost ? "lost" : null, "data-id": machine.id },
    el("th", { scope: "row" }, machine.id, el("span", { class: "host" }, machine.host)),
    el("td", {}, machine.version, el("span", { class: "host" }, `calculation ${machine.solver_version}`)),
    el("td", { class: "value" }, String(machine.slots)),
    el("td", {}, machine.lost && machine.running.length ? el("span", {}, "had: ", running) : running),
    el("td", {}, beat),
  );
}

/** @param {SystemState} system */
function fillWorkers({ machines, queue, now }) {
  const isLocal = queue.transport === "local";
  const there = machines.filter((machine) => !machine.lost);
  const note = isLocal
    ? "None: this service computes in its own process. It gives work to other machines when it is started with --queue nats://…"
    : there.length === 0 ? "None is there. Each machine that is to compute starts: herringbone worker --nats nats://…" : "";
  byId("workers-note").textContent = note;
  show(byId("workers-note"), note !== "");
  show(byId("workers-scroll"), machines.length > 0);
  rows.replaceChildren(...machines.map((machine) => rowOf(machine, Date.parse(now))));
  const names = new Set(there.map((machine) => machine.id));
  if (known) {
    const [came, went] = [[...names].filter((id) => !known?.has(id)), [...known].filter((id) => !names.has(id))];
    const said = [came.length ? `${named(came.length, "worker")} joined.` : "", went.length ? `${named(went.length, "worker")} left or lost.` : ""];
    if (came.length || went.length) byId("said").textContent = said.join(" ").trim();
  }
  known = names;
}

async function refresh() {
  try {
    const system = await api.system();
    notify(notice, null);
    fillService(system);
    fillWorkers(system);
    byId("waiting").replaceChildren(...reasons(system).map((reason) => el("li", {}, reason)));
    // Below the first card only once that has its height: nothing moves.
    show(byId("of-workers"), true);
    show(byId("of-waiting"), true);
  } catch (error) {
    notify(notice, error);
  }
}

async function follow() {
  if (!document.hidden) await refresh();
  window.setTimeout(follow, PAUSE_MS);
}

document.addEventListener("visibilitychange", () => {
  if (!document.hidden) refresh();
});
follow();
