// The form as it was left and the document submitted last, in the storage of the browser. Without storage nothing is
// kept.

const DRAFT = "herringbone.draft";
const SUBMITTED = "herringbone.submitted";

/** @param {string} key @returns {{ document: JobInput, at: string } | null} */
function read(key) {
  try {
    const kept = JSON.parse(localStorage.getItem(key) ?? "null");
    return kept && typeof kept.document === "object" ? kept : null;
  } catch {
    return null;
  }
}

/** @param {string} key @param {JobInput} document */
function write(key, document) {
  try {
    localStorage.setItem(key, JSON.stringify({ document, at: new Date().toISOString() }));
  } catch {
    // Full or forbidden: then nothing is kept.
  }
}

export const draft = () => read(DRAFT);
/** @param {JobInput} document */
export const keepDraft = (document) => write(DRAFT, document);
export const submitted = () => read(SUBMITTED);

/** Stores the submitted document and removes the draft. @param {JobInput} document */
export function keepSubmitted(document) {
  write(SUBMITTED, document);
  dropDraft();
}

export function dropDraft() {
  try {
    localStorage.removeItem(DRAFT);
  } catch {
    // Nothing was kept.
  }
}
