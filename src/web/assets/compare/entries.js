// The compared jobs in their order, each with its name, its letter and its line.

import { nameOf } from "../jobs/words.js";
import { mark } from "./chosen.js";

export const LETTERS = "ABCDE";
/** Length of a name in the legends, by the number of jobs: they are to leave room for the curves. */
const NAME_LENGTHS = [34, 34, 34, 26, 20, 18];

/**
 * @param {string[]} ids
 * @param {Map<string, import("./load.js").LoadedJob>} known
 * @param {(id: string) => number} slotOf the line of a job
 * @returns {ComparedJob[]}
 */
export function entriesOf(ids, known, slotOf) {
  return ids.map((id) => {
    const found = known.get(id) ?? { id, job: null };
    const slot = slotOf(id);
    const letter = LETTERS[slot];
    const name = found.job ? nameOf(found.job) : `Job …${id.slice(-6)}`;
    const most = NAME_LENGTHS[ids.length];
    const short = `${letter}  ${name.length > most ? `${name.slice(0, most - 1).trimEnd()}…` : name}`;
    return { ...found, slot, letter, name, short, mark: () => mark(letter, slot) };
  });
}
