// The page with the design form: what happens when a field changes, and submission.

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
let timer = null;
let touched = false;

/** Brings the page in line with the fields, and asks for a check a moment later. */
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

/** What the form has no field for is kept in the document until it is removed. */
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

/** Fills the form from a document; without one it stays as it is. */
function fill(document) {
  if (document) {
    writeDocument(form, document);
    changed();
  } else {
    refresh();
  }
}

async function submit(event) {
  event.preventDefault();
  clearTimeout(timer);
  check.stop();
  const button = byId("submit");
  button.disabled = true;
  const document = readDocument(form);
  try {
    const job = await api.submit(document, newKey());
    keepSubmitted(document);
    window.location.assign(`/jobs/${encodeURIComponent(job.id)}`);
  } catch (error) {
    if (touched) keepDraft(document);
    check.notSubmitted(error);
    showErrors(form, error, { summary: true });
    button.disabled = false;
  }
}

/** A new idempotency key; `crypto.randomUUID` exists only on secure origins. */
function newKey() {
  const bytes = crypto.getRandomValues(new Uint8Array(16));
  return [...bytes].map((byte) => byte.toString(16).padStart(2, "0")).join("");
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

/** "Table 1 of the source" becomes "table-1-of-the-source.json". */
function fileName({ name }) {
  const words = String(name ?? "").normalize("NFKD").toLowerCase().match(/[a-z0-9]+/g) ?? [];
  return `${words.join("-").slice(0, 60) || "herringbone-job"}.json`;
}

function save() {
  const document = readDocument(form);
  download(fileName(document), `${JSON.stringify(document, null, 2)}\n`);
}

/** A column of a spreadsheet goes into a list with its lines kept apart; the input itself would run them together. */
function pasteList(event) {
  const text = event.clipboardData?.getData("text/plain") ?? "";
  const list = event.target.closest("[data-control='numbers']");
  if (!list || !/[\r\n\t]/.test(text.trim())) return;
  event.preventDefault();
  const { value, selectionStart, selectionEnd } = event.target;
  event.target.setRangeText(text.trim().replace(/\s*[\r\n\t]+\s*/g, "; "), selectionStart ?? value.length, selectionEnd ?? value.length, "end");
  changed();
}

const isOfAField = (event) => event.target.closest("[data-pointer]") !== null;
form.addEventListener("input", (event) => isOfAField(event) && changed());
form.addEventListener("paste", pasteList);
form.addEventListener("submit", submit);
form.addEventListener("keydown", (event) => {
  if (event.key === "Enter" && (event.ctrlKey || event.metaKey)) form.requestSubmit();
});
byId("copy-curl").addEventListener("click", copyCurl);
byId("download").addEventListener("click", save);
byId("sections").addEventListener("click", (event) => {
  const link = event.target.closest("a");
  if (link) document.querySelector(link.hash).open = true;
});
show(byId("problems"), false);
initHelp(form);
initResets(form, changed);
initSweep(form, { readDocument: () => readDocument(form), changed });
initStart({ fill, read: () => readDocument(form), failed: (error) => showErrors(form, error, { summary: true }) })();
