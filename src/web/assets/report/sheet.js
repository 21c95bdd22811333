// What an engineer writes on a report: project, author, number of the drawing, notes. Kept in this browser.

import { byId, fillValues, show } from "../common/dom.js";

const KEY = "herringbone.report";
/** Fields that are the same on the next report, and those of one report. */
const COMMON = /** @type {const} */ (["project", "author"]);
const OWN = /** @type {const} */ (["drawing", "notes"]);

/** @param {string} key @returns {Record<string, string>} */
function stored(key) {
  // A browser may keep pages from storing anything.
  try {
    return JSON.parse(localStorage.getItem(key) ?? "{}");
  } catch {
    return {};
  }
}

/**
 * Fills the fields, and keeps what is typed.
 * @param {string} subject what the report is of: an id, or several
 * @param {string} [notes] notes on the job
 */
export function showSheet(subject, notes = "") {
  const own = `${KEY}.${subject}`;
  const kept = { notes, ...stored(KEY), ...stored(own) };
  const input = (/** @type {"project" | "author" | "drawing" | "notes"} */ name) => byId(`sheet-${name}`);
  for (const name of [...COMMON, ...OWN]) input(name).value = kept[name] ?? "";
  /** @param {readonly ("project" | "author" | "drawing" | "notes")[]} names */
  const typed = (names) => JSON.stringify(Object.fromEntries(names.map((name) => [name, input(name).value.trim()])));
  const update = () => {
    try {
      localStorage.setItem(KEY, typed(COMMON));
      localStorage.setItem(own, typed(OWN));
    } catch {
      // They hold for this page then.
    }
    fill();
  };
  const fill = () => {
    fillValues(byId("sheet-values"), [
      ["Project", input("project").value.trim()], ["Author", input("author").value.trim()], ["Drawing no.", input("drawing").value.trim()],
      ["Date of the report", new Date().toLocaleDateString()],
    ]);
    const text = input("notes").value.trim();
    byId("sheet-notes-printed").textContent = text;
    show(byId("sheet-notes-printed"), text !== "");
  };
  for (const name of [...COMMON, ...OWN]) input(name).addEventListener("input", update);
  fill();
  show(byId("sheet"));
}
