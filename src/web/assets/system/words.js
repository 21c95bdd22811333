// Why work waits, in words.

/** @param {number} count @param {string} noun */
export const named = (count, noun) => `${count} ${noun}${count === 1 ? "" : "s"}`;

/** @param {number} count */
const waits = (count) => (count === 1 ? "waits" : "wait");

/**
 * What waits and why: parts of running jobs that nobody computes, and jobs in the queue.
 * @param {SystemState} system
 * @returns {string[]}
 */
export function reasons({ queue, workers, machines, waiting_work: waiting, solver_version: version }) {
  const found = waiting.map((work) => `${named(work.chunks, "part")} of running jobs ${waits(work.chunks)} for calculation ${work.solver}: ${why(work, queue.connected, workers)}`);
  const held = machines.filter((machine) => machine.lost).flatMap((machine) => machine.running).length;
  if (held > 0) {
    found.push(`${named(held, "part")} ${held === 1 ? "was" : "were"} with workers that are lost: another worker gets each after ${queue.ack_wait_s ?? 30} s of silence.`);
  }
  if (queue.depth > 0) {
    const isNats = queue.transport === "nats";
    const reason = isNats && workers.total === 0 ? `no worker of version ${version} is there` : "those before them run first";
    found.push(`${named(queue.depth, "job")} in the queue ${waits(queue.depth)}: ${reason}.`);
  }
  return found.length ? found : ["Nothing waits."];
}

/**
 * @param {WaitingWork} work
 * @param {boolean | null | undefined} connected
 * @param {SystemState["workers"]} workers
 */
function why({ slots }, connected, workers) {
  if (connected === false) return "there is no connection to NATS.";
  if (slots === 0) return "no worker of this version is there.";
  if (workers.busy >= slots) return slots === 1 ? "the only thread is busy." : `all ${slots} threads are busy.`;
  return "a worker takes it within seconds.";
}
