// What this browser remembers: the form as it was left, and what was submitted last. Without storage nothing is kept.

const DRAFT = "herringbone.draft";
const SUBMITTED = "herringbone.submitted";

function read(key) {
  try {
    const kept = JSON.parse(localStorage.getItem(key));
    return kept && typeof kept.document === "object" ? kept : null;
  } catch {
    return null;
  }
}

function write(key, document) {
  try {
    localStorage.setItem(key, JSON.stringify({ document, at: new Date().toISOString() }));
  } catch {
    // Full or forbidden: then nothing is kept.
  }
}

export const draft = () => read(DRAFT);
export const keepDraft = (document) => write(DRAFT, document);
export const submitted = () => read(SUBMITTED);

/** After a submission the draft has become a job. */
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
