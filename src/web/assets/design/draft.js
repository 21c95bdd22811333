// What the browser keeps of the form: the draft of each tab, the drafts of closed tabs, the document submitted last,
// and the kind of start chosen last. Without storage nothing is kept.

const DRAFT = "herringbone.draft";
const DRAFTS = "herringbone.draft.";
const SUBMITTED = "herringbone.submitted";
const START = "herringbone.start";
/** Drafts of other tabs that are kept. */
const MOST_DRAFTS = 5;

/**
 * A document as it stood in the form, with what it was started from and which values of other geometry it has.
 * @typedef {Omit<ImportedModel, "document">} ImportReport
 * @typedef {{ kind: string, title: string, document: JobInput, id?: string, report?: ImportReport }} Start
 * @typedef {Record<string, { text: string, derived: number }>} Entered texts of fields, derived values at their entry
 * @typedef {{ document: JobInput, at: string, start?: Start, entered?: Entered, nameKept?: boolean }} Kept
 */

/** @param {() => Storage} storage @param {string} key @returns {any} */
function read(storage, key) {
  try {
    return JSON.parse(storage().getItem(key) ?? "null");
  } catch {
    return null;
  }
}

/** @param {() => Storage} storage @param {string} key @param {unknown} value null removes it */
function write(storage, key, value) {
  try {
    if (value === null) storage().removeItem(key);
    else storage().setItem(key, JSON.stringify(value));
  } catch {
    // Full or forbidden: then nothing is kept.
  }
}

// Asking for a storage that is forbidden throws.
const local = () => localStorage;
const tab = () => sessionStorage;

/** @param {any} kept @returns {Kept | null} */
const checked = (kept) => (kept && typeof kept.document === "object" && kept.document ? kept : null);

/**
 * Key of this page's draft among those of all tabs. A new one for each page: a tab that was duplicated has a copy of
 * the storage of the first.
 */
const OWN = `${DRAFTS}${[...crypto.getRandomValues(new Uint8Array(8))].map((byte) => byte.toString(16).padStart(2, "0")).join("")}`;

/** The draft of this tab. */
export function draft() {
  const kept = read(tab, DRAFT);
  return checked(kept) && { ...kept, key: undefined };
}

/** @param {Omit<Kept, "at">} contents */
export function keepDraft(contents) {
  const kept = { ...contents, at: new Date().toISOString() };
  const earlier = read(tab, DRAFT)?.key;
  if (earlier && earlier !== OWN) write(local, earlier, null);
  write(tab, DRAFT, { ...kept, key: OWN });
  write(local, OWN, kept);
  for (const { key } of allDrafts().slice(MOST_DRAFTS)) write(local, key, null);
}

export function dropDraft() {
  const key = read(tab, DRAFT)?.key;
  if (key) write(local, key, null);
  write(local, OWN, null);
  write(tab, DRAFT, null);
}

/** Drafts of all tabs, newest first. @returns {(Kept & { key: string })[]} */
function allDrafts() {
  /** @type {string[]} */
  let keys = [];
  try {
    keys = Object.keys(localStorage).filter((key) => key === DRAFT || key.startsWith(DRAFTS));
  } catch {
    // No storage: no drafts.
  }
  const found = keys.map((key) => ({ ...read(local, key), key })).filter((kept) => checked(kept));
  return found.toSorted((a, b) => String(b.at).localeCompare(String(a.at)));
}

/** Drafts of other tabs, open or closed, newest first. */
export function otherDrafts() {
  const own = [OWN, read(tab, DRAFT)?.key];
  return allDrafts().filter(({ key }) => !own.includes(key));
}

/** @param {string} key */
export const dropOther = (key) => write(local, key, null);

export const submitted = () => checked(read(local, SUBMITTED));

/**
 * Stores the submitted document, also with this entry of the history, so that Back returns it, and removes the draft.
 * @param {Omit<Kept, "at">} contents @param {string} job
 */
export function keepSubmitted(contents, job) {
  const kept = { ...contents, at: new Date().toISOString(), job };
  write(local, SUBMITTED, kept);
  history.replaceState({ submitted: kept }, "");
  dropDraft();
}

/** The document that was submitted from this entry of the history. @returns {(Kept & { job: string }) | null} */
export const submittedFromHere = () => /** @type {any} */ (checked(history.state?.submitted));

/** The start that the address of the form leads to: "empty", "example", or null before the first choice. */
export const rememberedStart = () => read(local, START);
/** @param {"empty" | "example"} kind */
export const rememberStart = (kind) => write(local, START, kind);
