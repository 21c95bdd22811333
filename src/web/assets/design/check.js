// The check while the form is edited: sends the document to the server and shows the answer beside the form.

import * as api from "../common/api.js";
import { byId, el, fillValues, show } from "../common/dom.js";
import { labelOf, number, unitOf } from "../common/format.js";
import { initDrawing } from "./drawing.js";
import { clearErrors, isOfADerivedValue, linkTo, problemItems, showErrors, showWarnings, warningItems } from "./errors.js";
import { initShaftsDrawing } from "./shafts.js";
import { durationOf } from "./sweep_cost.js";

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

/** @typedef {import("./document.js").Field} Field */

/**
 * Sets up the check; `run(document)` checks and shows the answer, and returns the report, or null where there is none.
 * `checked(report)` is called with each report, and returns the fields with values of another geometry; `refused()`
 * where the document was refused.
 * @param {HTMLFormElement} form
 * @param {{ checked: (report: CheckedDocument) => Promise<Field[]>, refused: () => void }} options
 */
export function initCheck(form, { checked, refused }) {
  const drawings = [initDrawing(), initShaftsDrawing()];
  const fadeDrawings = () => drawings.forEach((drawing) => drawing.fade());
  /** @type {AbortController | null} */
  let asking = null;

  function stop() {
    asking?.abort();
    asking = null;
  }

  /** @param {JobInput} document @returns {Promise<CheckedDocument | null>} */
  async function run(document) {
    stop();
    asking = new AbortController();
    const { signal } = asking;
    byId("check-bar").setAttribute("aria-busy", "true");
    try {
      const report = await api.validate(document, { drawing: true, signal });
      if (signal.aborted) return null;
      const stale = await checked(report);
      if (signal.aborted) return null;
      clearErrors(form);
      showReport(form, report, stale);
      showWarnings(form, report.warnings);
      const { drawing: drawn } = report;
      if (drawn) drawings.forEach((drawing) => drawing.show(drawn));
      return report;
    } catch (error) {
      if (signal.aborted) return null;
      if (!(error instanceof api.Problem)) throw error;
      refused();
      fade();
      fadeDrawings();
      showRefusal(form, error, showErrors(form, error, { summary: false }));
      return null;
    } finally {
      if (!signal.aborted) byId("check-bar").removeAttribute("aria-busy");
    }
  }

  /** Shows that the submission was refused: for its document, or for another reason. @param {any} error */
  function notSubmitted(error) {
    byId("check-bar").removeAttribute("aria-busy");
    const entries = showErrors(form, error, { summary: true });
    setState("bad", "Not submitted");
    list(problemItems(form, entries));
    if (!entries.length) return;
    fade();
    fadeDrawings();
  }

  /** Forgets the last pair: the form was filled with another. */
  function clear() {
    fade();
    drawings.forEach((drawing) => drawing.clear());
    for (const value of byId("check-geometry").querySelectorAll("dd")) value.textContent = "–";
    byId("check-values").replaceChildren();
    byId("check-gears").tBodies[0].replaceChildren();
    byId("to-results").textContent = "Drawing and results";
  }

  return { run, stop, notSubmitted, clear };
}

/** The problems beside the state, with links. @param {HTMLElement[]} items */
function list(items) {
  byId("check-problems").replaceChildren(...items);
  show(byId("check-problems"), items.length > 0);
  show(byId("show-problems"), items.length > 0);
  byId("show-problems").textContent = items.length === 1 ? "Show it" : `Show all ${items.length}`;
}

/** @param {HTMLElement} form @param {api.Problem} error @param {import("./errors.js").Entry[]} entries */
function showRefusal(form, error, entries) {
  const todo = entries.filter((entry) => entry.todo).length;
  const wrong = entries.length - todo;
  const counted = (count) => `${count} ${count === 1 ? "field" : "fields"}`;
  if (wrong) setState("bad", `${counted(wrong)} ${wrong === 1 ? "needs" : "need"} attention${todo ? `, ${todo} still to fill in` : ""}`);
  else if (todo) setState("todo", `${counted(todo)} still to fill in`);
  else setState("bad", error.message);
  list(problemItems(form, entries.toSorted((a, b) => Number(a.todo) - Number(b.todo))));
}

/** @param {string} kind @param {string} text */
function setState(kind, text) {
  const state = byId("check-state");
  // The same words again would be read out again.
  if (state.textContent === text) return;
  state.className = `state ${kind}`;
  state.textContent = text;
}

/**
 * @param {HTMLElement} form
 * @param {CheckedDocument} report
 * @param {Field[]} stale fields with values of another geometry
 */
function showReport(form, { geometry, drawing, memory_mib: memory, warnings, estimate }, stale) {
  const margins = drawing?.margins ?? [];
  const derived = warnings.filter(isOfADerivedValue);
  const told = warnings.filter((warning) => !isOfADerivedValue(warning));
  const found = [
    stale.length ? `${stale.length} ${stale.length === 1 ? "value" : "values"} of another geometry` : "",
    told.length ? `${told.length} ${told.length === 1 ? "warning" : "warnings"}` : "",
  ].filter(Boolean);
  setState(found.length ? "good warned" : "good", ["Can be solved", ...found].join(", "));
  list(stale.map((field) => el("li", {}, linkTo(field), " entered for another geometry")));
  byId("estimate").textContent = timeText(estimate);
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
  byId("check-warnings").replaceChildren(...warningItems(form, told));
  byId("check-derived").replaceChildren(...warningItems(form, derived));
  show(byId("derived-values"), derived.length > 0);
}

/** @param {CheckedDocument["estimate"]} estimate */
function timeText({ wall_time_s: median, shortest_s: shortest, longest_s: longest, jobs, kind, points }) {
  if (typeof median !== "number") return "Computing time: no job like this was measured yet.";
  const spread = jobs > 1 && typeof shortest === "number" && typeof longest === "number" ? ` (${durationOf(shortest)} to ${durationOf(longest)})` : "";
  const measured = kind === "response" && points > 1 ? "single points" : jobs === 1 ? "job like this" : "jobs like this";
  return `Computing time: about ${durationOf(median)}${spread}, by ${number(jobs)} ${measured}.`;
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

/** A ratio with four decimals: it keeps its width while the form is edited. @param {number} value */
const fixed = (value, decimals = 4) => (Number.isFinite(value) ? value.toFixed(decimals) : "–");

function fade() {
  byId("checked").classList.add("stale");
  byId("check-warnings").replaceChildren();
  show(byId("derived-values"), false);
}
