// The page with the design form: live check, errors at their fields, submission.

import * as api from "../common/api.js";
import { byId, download, fillValues, fillWarnings, show } from "../common/dom.js";
import { applyConditions, readDocument, writeDocument } from "./document.js";
import { clearErrors, showErrors } from "./errors.js";
import { labelOf, number, unitOf } from "../common/format.js";
import { initSweep } from "./sweep.js";

const CHECK_AFTER_MS = 400;
const CHECKED = [
  "transverse_contact_ratio", "overlap_ratio", "total_contact_ratio", "working_pressure_angle_deg", "center_distance_mm", "mesh_frequency_hz",
];

const form = byId("design");
const checkState = byId("check-state");
let timer = null;
let checking = null;

function changed() {
  applyConditions(form);
  byId("document-text").textContent = JSON.stringify(readDocument(form), null, 2);
  clearTimeout(timer);
  timer = setTimeout(check, CHECK_AFTER_MS);
}

async function check() {
  checking?.abort();
  checking = new AbortController();
  const { signal } = checking;
  checkState.textContent = "Checking …";
  try {
    const report = await api.validate(readDocument(form), signal);
    if (signal.aborted) return;
    clearErrors(form);
    setState("good", report.warnings.length ? "Can be solved; see the warnings." : "Can be solved.");
    fillValues(byId("check-geometry"), CHECKED.map((name) => [labelOf(name), number(report.geometry[name]), unitOf(name)]));
    fillWarnings(byId("check-warnings"), report.warnings);
  } catch (error) {
    if (signal.aborted) return;
    fillValues(byId("check-geometry"), []);
    fillWarnings(byId("check-warnings"), []);
    const count = error.errors?.length ?? 0;
    setState("bad", count ? `${count} ${count === 1 ? "field needs" : "fields need"} attention.` : error.message);
    showErrors(form, error, { summary: false });
  }
}

function setState(kind, text) {
  checkState.className = `state ${kind}`;
  checkState.textContent = text;
}

async function submit(event) {
  event.preventDefault();
  clearTimeout(timer);
  checking?.abort();
  const button = byId("submit");
  button.disabled = true;
  try {
    const job = await api.submit(readDocument(form), newKey());
    window.location.assign(`/jobs/${encodeURIComponent(job.id)}`);
  } catch (error) {
    setState("bad", "Not submitted.");
    showErrors(form, error, { summary: true });
    button.disabled = false;
  }
}

/** A new idempotency key; `crypto.randomUUID` exists only on secure origins. */
function newKey() {
  const bytes = crypto.getRandomValues(new Uint8Array(16));
  return [...bytes].map((byte) => byte.toString(16).padStart(2, "0")).join("");
}

function fill(document) {
  const unplaced = writeDocument(form, document);
  byId("document-note").textContent = unplaced.length ? `Not in this form, left out: ${unplaced.join(", ")}` : "";
  changed();
}

async function upload(event) {
  const [file] = event.target.files;
  event.target.value = "";
  if (!file) return;
  try {
    const document = JSON.parse(await file.text());
    if (document === null || typeof document !== "object" || Array.isArray(document)) throw new Error("it is not a JSON object");
    fill(document);
  } catch (error) {
    byId("document-note").textContent = `${file.name} is not a job document: ${error.message}`;
  }
}

async function copyCurl() {
  const body = JSON.stringify(readDocument(form), null, 2).replaceAll("'", "'\\''");
  const command = `curl -sS -X POST ${api.submitUrl()} -H 'Content-Type: application/json' -d '${body}'\n`;
  const note = byId("document-note");
  try {
    await navigator.clipboard.writeText(command);
    note.textContent = "Copied.";
  } catch {
    byId("document-text").textContent = command;
    note.textContent = "The clipboard is not available: copy the command below.";
  }
}

async function start() {
  const from = new URLSearchParams(window.location.search).get("from");
  if (from) {
    try {
      fill(await api.input(from));
      return;
    } catch (error) {
      showErrors(form, error, { summary: true });
    }
  }
  changed();
}

form.addEventListener("input", changed);
form.addEventListener("submit", submit);
byId("upload").addEventListener("change", upload);
byId("upload").addEventListener("input", (event) => event.stopPropagation());
byId("copy-curl").addEventListener("click", copyCurl);
byId("download").addEventListener("click", () => download("job.json", JSON.stringify(readDocument(form), null, 2)));
byId("reset").addEventListener("click", () => window.location.assign("/"));
show(byId("problems"), false);
initSweep(form, { readDocument: () => readDocument(form), changed });
start();
