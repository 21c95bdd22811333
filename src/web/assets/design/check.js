// The check while the form is edited: sends the document to the server and shows the answer beside the form.

import * as api from "../common/api.js";
import { byId, el, fillValues } from "../common/dom.js";
import { labelOf, number, unitOf } from "../common/format.js";
import { initDrawing } from "./drawing.js";
import { fieldAt, fieldsOf } from "./document.js";
import { clearErrors, linkTo, showErrors, showWarnings } from "./errors.js";

/** @type {["transverse_contact_ratio" | "overlap_ratio" | "total_contact_ratio", string, string][]} */
const HEADLINE = [
  ["transverse_contact_ratio", "Transverse", "εα"],
  ["overlap_ratio", "Overlap", "εβ"],
  ["total_contact_ratio", "Total", "εγ"],
];
/** @type {(Exclude<keyof Geometry, "pinion" | "gear">)[]} */
const VALUES = ["center_distance_mm", "working_pressure_angle_deg", "transverse_pressure_angle_deg", "base_helix_angle_deg", "path_of_contact_mm", "mesh_frequency_hz"];
/** @type {[keyof Geometry["pinion"], string][]} */
const DIAMETERS = [
  ["tip_diameter_mm", "Tip ø"],
  ["reference_diameter_mm", "Reference ø"],
  ["base_diameter_mm", "Base ø"],
  ["root_diameter_mm", "Root ø"],
];
/** @type {("pinion" | "gear")[]} */
const SIDES = ["pinion", "gear"];
/** Label and unit of the margins by the codes of the check. */
const MARGINS = {
  "tip-thickness": ["Tip thickness", "m_n"],
  "tip-clearance": ["Tip clearance", "m_n"],
  "profile-shift": ["Profile shift (undercut)", ""],
  "active-profile": ["Active profile from ø", "mm"],
};

/**
 * Sets up the check; `run(document)` checks and shows the answer.
 * @param {HTMLFormElement} form
 */
export function initCheck(form) {
  const drawing = initDrawing();
  /** @type {AbortController | null} */
  let asking = null;

  function stop() {
    asking?.abort();
    asking = null;
  }

  /** @param {JobInput} document */
  async function run(document) {
    stop();
    asking = new AbortController();
    const { signal } = asking;
    byId("check-bar").setAttribute("aria-busy", "true");
    try {
      const report = await api.validate(document, { drawing: true, signal });
      if (signal.aborted) return;
      clearErrors(form);
      showReport(report);
      showWarnings(form, report.warnings);
      if (report.drawing) drawing.show(report.drawing);
    } catch (error) {
      if (signal.aborted) return;
      if (!(error instanceof api.Problem)) throw error;
      const count = error.errors.length;
      setState("bad", count ? `${count} ${count === 1 ? "field needs" : "fields need"} attention` : error.message);
      fade();
      drawing.fade();
      showErrors(form, error, { summary: false });
    } finally {
      if (!signal.aborted) byId("check-bar").removeAttribute("aria-busy");
    }
  }

  /** Shows that the submission was refused: for its document, or for another reason. @param {any} error */
  function notSubmitted(error) {
    byId("check-bar").removeAttribute("aria-busy");
    setState("bad", "Not submitted");
    if (!error.errors?.length) return;
    fade();
    drawing.fade();
  }

  return { run, stop, notSubmitted };
}

/** @param {string} kind @param {string} text */
function setState(kind, text) {
  const state = byId("check-state");
  // The same words again would be read out again.
  if (state.textContent === text) return;
  state.className = `state ${kind}`;
  state.textContent = text;
}

/** @param {CheckedDocument} report */
function showReport({ geometry, drawing, memory_mib: memory, warnings }) {
  const margins = drawing?.margins ?? [];
  const count = warnings.length;
  setState(count ? "good warned" : "good", count ? `Can be solved, ${count} ${count === 1 ? "warning" : "warnings"}` : "Can be solved");
  byId("checked").classList.remove("stale");
  // On a narrow screen the link to the results contains the most important of them.
  byId("to-results").textContent = HEADLINE.map(([name, , symbol]) => `${symbol} ${fixed(geometry[name], 2)}`).join("  ");
  byId("check-geometry").replaceChildren(
    ...HEADLINE.map(([name, label, symbol]) =>
      el("div", {}, el("dt", {}, label, " ", el("span", { class: "symbol" }, symbol)), el("dd", {}, fixed(geometry[name]))),
    ),
  );
  fillValues(byId("check-values"), [
    ...VALUES.map((name) => /** @type {ValueRow} */ ([labelOf(name), number(geometry[name], 6), unitOf(name)])),
    ["Memory, at most", memory < 1 ? "1" : number(memory, 3), "MiB"],
  ]);
  byId("check-gears").tBodies[0].replaceChildren(
    ...DIAMETERS.map(([name, label]) => row(label, "mm", SIDES.map((side) => el("td", {}, number(geometry[side][name], 6))))),
    ...Object.entries(MARGINS).map(([code, [label, unit]]) => row(label, unit, SIDES.map((side) => marginCell(margins.find((one) => one.code === code && one.member === side))))),
  );
  listWarnings(byId("check-warnings"), warnings);
}

/** @param {string} label @param {string} unit @param {Node[]} cells */
const row = (label, unit, cells) => el("tr", {}, el("th", { scope: "row" }, label, unit ? el("span", { class: "unit" }, ` ${unit === "m_n" ? "/ mₙ" : unit}`) : null), ...cells);

/**
 * The value with its limit; below the limit it is marked, in words too.
 * @param {PairDrawing["margins"][number]} [margin]
 */
function marginCell(margin) {
  if (!margin) return el("td", {}, "–");
  const low = margin.value < margin.limit;
  const limit = el("span", { class: "limit" }, `${low ? "below" : "≥"} ${number(margin.limit, 4)}`);
  return el("td", { class: low ? "low" : null }, number(margin.value, 4), " ", limit);
}

/** Warnings in full, with links to their fields. @param {HTMLElement} list @param {WarningEntry[]} warnings */
function listWarnings(list, warnings) {
  const fields = fieldsOf(byId("design"));
  list.replaceChildren(
    ...warnings.map(({ code, detail, pointer }) => {
      const field = fieldAt(fields, pointer ?? "");
      const place = field ? linkTo(field) : el("code", {}, pointer);
      return el("li", {}, el("strong", {}, code.replaceAll("-", " ")), ` ${detail}. `, place);
    }),
  );
}

/** A ratio with four decimals: it keeps its width while the form is edited. @param {number} value */
const fixed = (value, decimals = 4) => (Number.isFinite(value) ? value.toFixed(decimals) : "–");

function fade() {
  byId("checked").classList.add("stale");
  byId("check-warnings").replaceChildren();
}
