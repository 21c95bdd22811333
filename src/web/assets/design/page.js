// The page with the design form: reactions to changes of its fields, and submission.

import * as api from "../common/api.js";
import { byAnyId, byId, download, el, show } from "../common/dom.js";
import { changesFrom, showChanges } from "./changes.js";
import { initCheck } from "./check.js";
import { initDependent } from "./dependent.js";
import { applyConditions, dropExtras, extraPointers, fieldsOf, readDocument, textOf, writeDocument } from "./document.js";
import { dropDraft, keepDraft, keepSubmitted } from "./draft.js";
import { forgetEdits, linkTo, noteEdit, requireAll, say, showReadings } from "./errors.js";
import { initHelp } from "./help.js";
import { listImport, showImport } from "./imported.js";
import { initLists } from "./lists.js";
import { initStart } from "./start.js";
import { initResets, showWhatIsSet } from "./summary.js";
import { initSweep } from "./sweep.js";
import { initVary } from "./vary.js";

const CHECK_AFTER_MS = 250;

/** @typedef {import("./start.js").Contents} Contents */

const form = byId("design");
const dependent = initDependent(form, changed);
const check = initCheck(form, { checked, refused: () => { dependent.fade(); showReadings(form); } });
/** @type {number | undefined} */
let timer;
let touched = false;
/** Number of checks that were started. */
let checks = 0;
/** @type {import("./draft.js").Start} */
let started = { kind: "example", title: "the example pair", document: readDocument(form) };
/** Name and label of the example, taken out when it became another pair. @type {Record<string, string>} */
let takenOut = {};
/** Whether the name of the start is wanted for a document that differs from it. */
let nameKept = false;
/** The document that the form was filled with, until its derived values are known. @type {JobInput | null} */
let unsettled = null;
/** @type {Promise<void>} */
let settling = Promise.resolve();

/** @returns {Contents} */
const contents = () => ({ document: readDocument(form), start: started, entered: dependent.entered(), nameKept });

/** A check is due or runs: the form says so until its answer is shown. */
function awaitCheck() {
  form.dataset.pending = "";
  checks += 1;
  return checks;
}

/** Brings the page in line with the fields, and starts a check a moment later. */
function refresh() {
  applyConditions(form);
  takeNameOut();
  showWhatIsSet(form);
  showReadings(form);
  showChanges(form, started, dependent.stale());
  showImport(form, started);
  const document = readDocument(form);
  byId("document-text").textContent = JSON.stringify(document, null, 2);
  showExtras();
  check.stop();
  clearTimeout(timer);
  const mine = awaitCheck();
  timer = setTimeout(async () => {
    if (touched) keep();
    await check.run(document);
    if (mine === checks) delete form.dataset.pending;
  }, CHECK_AFTER_MS);
}

/** Starts that are nowhere but in the form: the page does not get to see the file again. */
const ONLY_HERE = ["file", "import"];

/** Keeps what stands in the form, unless it is what it was started with and can be had again. */
function keep() {
  const now = contents();
  const isStart = JSON.stringify(now.document) === JSON.stringify(started.document);
  if (isStart && !ONLY_HERE.includes(started.kind)) dropDraft();
  else keepDraft(now);
}

function changed() {
  touched = true;
  if (unsettled) {
    const first = unsettled;
    unsettled = null;
    // Of a document that is refused no derived values are known: the first that can be checked counts.
    settling = api.validate(first).then(({ derived }) => dependent.settle(first, derived), () => {});
  }
  refresh();
}

/** Both shafts of the document that was checked last, as they are solved. @type {any} */
let solvedShafts = null;

/** Puts the derived shafts into the fields, so that they can be edited. */
function editShafts() {
  if (!solvedShafts) return;
  const document = readDocument(form);
  document.design.shafts = solvedShafts;
  writeDocument(form, document);
  changed();
  byAnyId("field-design-shafts").focus();
}

/** @param {CheckedDocument} report @returns {Promise<import("./document.js").Field[]>} */
async function checked({ derived, shafts }) {
  unsettled = null;
  await settling;
  dependent.update(derived);
  showReadings(form);
  solvedShafts = shafts ?? null;
  show(byId("shafts-take-over"), Boolean(shafts && readDocument(form).design.shafts?.arrangement));
  const stale = dependent.stale();
  showChanges(form, started, stale);
  return stale;
}

const NAMES = ["/name", "/label"];

/** Takes the example's name and label out as soon as the document is no longer the example. */
function takeNameOut() {
  const changes = changesFrom(form, started).map(({ field: { pointer } }) => pointer).filter((pointer) => !NAMES.includes(pointer));
  const isExample = started.kind === "example";
  const isOtherDesign = changes.some((pointer) => pointer.startsWith("/design/"));
  for (const field of fieldsOf(form).filter(({ pointer }) => NAMES.includes(pointer))) {
    const given = started.document[field.pointer.slice(1)] ?? "";
    const isOfTheStart = given !== "" && textOf(field) === given;
    if (isExample && changes.length && isOfTheStart && !nameKept) {
      takenOut[field.pointer] = given;
      field.input.value = "";
    }
    if (textOf(field) !== "") delete takenOut[field.pointer];
    const back = el("button", { type: "button", class: "quiet", "aria-label": `${field.label}: Put it back` }, "Put it back");
    back.addEventListener("click", () => {
      nameKept = true;
      field.input.value = given;
      field.input.focus();
      changed();
    });
    if (takenOut[field.pointer]) say(field, "stale", ["the example’s was taken out: this is no longer the example ", back]);
    else say(field, "stale", isOfTheStart && !isExample && isOtherDesign ? [`still that of ${started.title}`] : []);
  }
}

/** Shows the members of the document without a field: they are kept until they are removed. */
function showExtras() {
  const places = extraPointers().map((pointer) => pointer.split("/").filter((name) => name && !/^\d+$/.test(name)).join(" › "));
  const names = [...new Set(places)].map((name) => `“${name}”`);
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

/** Fills the form; what was chosen by hand is kept as a draft. @param {Contents} filled @param {boolean} [isChosen] */
function fill({ document, start, entered, nameKept: kept = false }, isChosen = false) {
  writeDocument(form, document);
  started = start;
  takenOut = {};
  nameKept = kept;
  forgetEdits();
  dependent.reset(entered);
  if (start.kind === "empty") check.clear();
  unsettled = document;
  touched = isChosen;
  listImport(form, start);
  refresh();
}

/** @param {Event} event */
async function submit(event) {
  event.preventDefault();
  const button = byId("submit");
  // Keys can ask again while it is submitted.
  if (button.disabled) return;
  clearTimeout(timer);
  check.stop();
  button.disabled = true;
  awaitCheck();
  requireAll();
  const document = readDocument(form);
  try {
    const { derived } = await api.validate(document);
    await settling;
    dependent.update(derived);
    if (dependent.stale().length) {
      button.disabled = false;
      return askAboutStale();
    }
    const job = await api.submit(document, api.newKey());
    keepSubmitted({ ...contents(), document }, job.id);
    touched = false;
    window.location.assign(`/jobs/${encodeURIComponent(job.id)}`);
  } catch (error) {
    if (touched) keep();
    check.notSubmitted(error);
    button.disabled = false;
    delete form.dataset.pending;
  }
}

/** Asks what shall become of values that were entered for another geometry, before anything is submitted. */
async function askAboutStale() {
  await check.run(readDocument(form));
  const stale = dependent.stale();
  const answer = (text, act) => {
    const button = el("button", { type: "button" }, text);
    button.addEventListener("click", () => {
      act();
      touched = true;
      refresh();
      form.requestSubmit();
    });
    return button;
  };
  const one = stale.length === 1;
  const problems = byId("problems");
  problems.replaceChildren(
    el("strong", {}, `Not submitted yet: ${one ? "a value was" : `${stale.length} values were`} entered for another geometry.`),
    el("ul", {}, ...stale.map((field) => el("li", {}, linkTo(field), ` ${[textOf(field), field.unit].filter(Boolean).join(" ")}`))),
    el("p", { class: "actions" },
      answer(one ? "Use the derived value and submit" : "Use the derived values and submit", dependent.useAll), " ",
      answer(one ? "Keep it and submit" : "Keep them and submit", dependent.keepAll)),
  );
  show(problems);
  problems.focus();
  delete form.dataset.pending;
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

form.addEventListener("input", (event) => {
  const box = /** @type {HTMLElement | null} */ (/** @type {Element} */ (event.target).closest("[data-pointer]"));
  // The number of objects in a list counts once it is entered.
  if (!box || box.dataset.control === "list") return;
  noteEdit(box.dataset.pointer ?? "");
  changed();
});
form.addEventListener("paste", pasteList);
form.addEventListener("submit", submit);
form.addEventListener("keydown", (event) => {
  if (event.key !== "Enter") return;
  if (event.ctrlKey || event.metaKey) {
    event.preventDefault();
    form.requestSubmit();
  } else if (/** @type {Element} */ (event.target).matches("input")) {
    // It would submit from every field.
    event.preventDefault();
  }
});
byId("copy-curl").addEventListener("click", copyCurl);
byId("download").addEventListener("click", save);
byId("show-problems").addEventListener("click", () => {
  const open = byId("check-bar").classList.toggle("open");
  byId("show-problems").setAttribute("aria-expanded", String(open));
});
byId("sections").addEventListener("click", (event) => {
  const link = /** @type {Element} */ (event.target).closest("a");
  if (link) /** @type {HTMLDetailsElement} */ (document.querySelector(link.hash)).open = true;
});
show(byId("problems"), false);
initHelp(form);
initResets(form, changed);
initLists(form, changed);
byId("shafts-edit").addEventListener("click", editShafts);
initSweep(form, { readDocument: () => readDocument(form), changed });
initVary(form, changed);
const start = initStart({ fill, read: contents });
start();
// What was typed last is kept even where the page is left before its check.
window.addEventListener("pagehide", () => {
  if (touched) keep();
});
// Back from the job, where the browser has kept the page as it was.
window.addEventListener("pageshow", (event) => {
  if (!event.persisted) return;
  byId("submit").disabled = false;
  start();
});
