// The page with the design form: reactions to changes of its fields, and submission.

import * as api from "../common/api.js";
import { byId, download, el, show } from "../common/dom.js";
import { initCheck } from "./check.js";
import { applyConditions, dropExtras, extraPointers, readDocument, writeDocument } from "./document.js";
import { keepDraft, keepSubmitted } from "./draft.js";
import { showErrors, showReadings } from "./errors.js";
import { initHelp } from "./help.js";
import { initStart } from "./start.js";
import { initResets, showWhatIsSet } from "./summary.js";
import { initSweep } from "./sweep.js";

const CHECK_AFTER_MS = 250;

const form = byId("design");
const check = initCheck(form);
/** @type {number | undefined} */
let timer;
let touched = false;

/** Brings the page in line with the fields, and starts a check a moment later. */
function refresh() {
  applyConditions(form);
  showWhatIsSet(form);
  showReadings(form);
  const document = readDocument(form);
  byId("document-text").textContent = JSON.stringify(document, null, 2);
  showExtras();
  clearTimeout(timer);
  timer = setTimeout(() => {
    if (touched) keepDraft(document);
    check.run(document);
  }, CHECK_AFTER_MS);
}

function changed() {
  touched = true;
  refresh();
}

/** Shows the members of the document without a field: they are kept until they are removed. */
function showExtras() {
  const names = extraPointers();
  const note = byId("extras");
  show(note, names.length > 0);
  if (!names.length) return;
  const remove = el("button", { type: "button", class: "quiet" }, names.length > 1 ? "Remove them" : "Remove it");
  remove.addEventListener("click", () => {
    dropExtras();
    changed();
    byId("submit").focus();
  });
  note.replaceChildren(`Not in this form, kept in the document: ${names.join(", ")} `, remove);
}

/** Fills the form from a document; without one it stays as it is. @param {JobInput} document */
function fill(document) {
  if (document) {
    writeDocument(form, document);
    changed();
  } else {
    refresh();
  }
}

/** @param {Event} event */
async function submit(event) {
  event.preventDefault();
  clearTimeout(timer);
  check.stop();
  const button = byId("submit");
  button.disabled = true;
  const document = readDocument(form);
  try {
    const job = await api.submit(document, api.newKey());
    keepSubmitted(document);
    window.location.assign(`/jobs/${encodeURIComponent(job.id)}`);
  } catch (error) {
    if (touched) keepDraft(document);
    check.notSubmitted(error);
    showErrors(form, error, { summary: true });
    button.disabled = false;
  }
}

async function copyCurl() {
  const body = JSON.stringify(readDocument(form), null, 2).replaceAll("'", "'\\''");
  const login = form.dataset.login === undefined ? "" : ' -H "Authorization: Bearer $HERRINGBONE_TOKEN"';
  const command = `curl -sS -X POST '${api.submitUrl()}'${login} -H 'Content-Type: application/json' -d '${body}'\n`;
  const note = byId("document-note");
  const hint = login ? " Put the service's token into HERRINGBONE_TOKEN." : "";
  try {
    await navigator.clipboard.writeText(command);
    note.textContent = `Copied.${hint}`;
  } catch {
    byId("document-text").textContent = command;
    byId("document-panel").open = true;
    note.textContent = `The clipboard is not available: copy the command below.${hint}`;
  }
}

/** "Table 1 of the source" becomes "table-1-of-the-source.json". @param {JobInput} document */
function fileName({ name }) {
  const words = String(name ?? "").normalize("NFKD").toLowerCase().match(/[a-z0-9]+/g) ?? [];
  return `${words.join("-").slice(0, 60) || "herringbone-job"}.json`;
}

function save() {
  const document = readDocument(form);
  download(fileName(document), `${JSON.stringify(document, null, 2)}\n`);
}

/**
 * Pastes a column of a spreadsheet into a list with its lines separated; the input itself would join them.
 * @param {ClipboardEvent} event
 */
function pasteList(event) {
  const text = event.clipboardData?.getData("text/plain") ?? "";
  const input = /** @type {HTMLInputElement} */ (event.target);
  const list = input.closest("[data-control='numbers']");
  if (!list || !/[\r\n\t]/.test(text.trim())) return;
  event.preventDefault();
  const { value, selectionStart, selectionEnd } = input;
  input.setRangeText(text.trim().replace(/\s*[\r\n\t]+\s*/g, "; "), selectionStart ?? value.length, selectionEnd ?? value.length, "end");
  changed();
}

/** @param {Event} event */
const isOfAField = (event) => /** @type {Element} */ (event.target).closest("[data-pointer]") !== null;
form.addEventListener("input", (event) => isOfAField(event) && changed());
form.addEventListener("paste", pasteList);
form.addEventListener("submit", submit);
form.addEventListener("keydown", (event) => {
  if (event.key === "Enter" && (event.ctrlKey || event.metaKey)) form.requestSubmit();
});
byId("copy-curl").addEventListener("click", copyCurl);
byId("download").addEventListener("click", save);
byId("sections").addEventListener("click", (event) => {
  const link = /** @type {Element} */ (event.target).closest("a");
  if (link) /** @type {HTMLDetailsElement} */ (document.querySelector(link.hash)).open = true;
});
show(byId("problems"), false);
initHelp(form);
initResets(form, changed);
initSweep(form, { readDocument: () => readDocument(form), changed });
initStart({ fill, read: () => readDocument(form), failed: (error) => showErrors(form, error, { summary: true }) })();
