// Gear models of other programs: the report of an import beside the form, and marks on the fields that were taken from
// the file or assumed.

import { byId, el, show } from "../common/dom.js";
import { number, shownUnit } from "../common/format.js";
import { fieldsOf, isSame, textIn, textOf } from "./document.js";
import { linkTo, say } from "./errors.js";

/** @typedef {import("./document.js").Field} Field */
/** @typedef {import("./draft.js").Start} Start */
/** @typedef {import("./draft.js").ImportReport} ImportReport */

/** Most lines of a list that is open at first. */
const MOST_OPEN = 12;

/**
 * What became of a file, in a sentence.
 * @param {string} name @param {ImportReport} report
 */
export function summaryOf(name, { pair, taken, assumed }) {
  const mirrored = pair.mirrored ? ", mirrored" : "";
  return `From the model ${name}: ${pair.label}${mirrored}. ${taken.length} fields taken, ${assumed.length} assumed; see “Imported”.`;
}

/**
 * Why a file was refused, and what can be chosen instead.
 * @param {string} name @param {any} error
 * @returns {{ text: string, pairs: { label: string, pair: number, mirror: boolean }[], needsTorque: boolean }}
 */
export function refusalOf(name, error) {
  /** @type {Violation[]} */
  const errors = error.errors ?? [];
  const pairs = errors.flatMap(({ pointer, detail }) => {
    const pair = Number(pointer.match(/^\/pair\/(\d+)$/)?.[1]);
    const mirror = /, (single-helical|spur)$|; mirror makes/.test(detail);
    return pair ? [{ label: `${mirror ? "Mirror" : "Take"} ${detail.replace(/, (single-helical|double-helical|spur)$/, "")}`, pair, mirror }] : [];
  });
  const reasons = errors.filter(({ pointer }) => !/^\/pair\/\d+$/.test(pointer)).map(({ detail }) => detail);
  const needsTorque = errors.length === 1 && errors[0].pointer === "/operation/pinion_torque_nm" && errors[0].code === "missing";
  const summary = error.problem?.detail ?? error.message ?? String(error);
  return { text: [`${name}: ${summary}`, ...reasons.slice(0, 5)].join(" – "), pairs, needsTorque };
}

/** Asks for a torque that is not in the file. @param {(torqueNm: number) => void} answer */
export function torqueQuestion(answer) {
  const input = el("input", { type: "text", inputMode: "decimal", id: "import-torque", size: 8 });
  const button = el("button", { type: "button" }, "Import with it");
  button.addEventListener("click", () => {
    const torqueNm = Number(input.value.replace(",", "."));
    if (input.value.trim() !== "" && Number.isFinite(torqueNm)) answer(torqueNm);
    else input.focus();
  });
  return el("span", {}, el("label", { htmlFor: "import-torque" }, "Torque of the pinion, N·m "), input, " ", button);
}

/**
 * Marks the fields that still have what was imported, and shows the report.
 * @param {HTMLElement} form @param {Start} start
 */
export function showImport(form, start) {
  const { report } = start;
  show(byId("imported"), Boolean(report));
  const taken = new Map((report?.taken ?? []).map((line) => [line.pointer, line]));
  const assumed = new Map((report?.assumed ?? []).map((line) => [line.pointer, line]));
  for (const field of fieldsOf(form)) {
    const unchanged = report && isSame(field, textOf(field), textIn(field, start.document));
    const from = unchanged ? taken.get(field.pointer) : undefined;
    const why = unchanged ? assumed.get(field.pointer) : undefined;
    const origin = from ? `from the file: ${from.from}${from.why ? ` (${from.why})` : ""}` : why ? `assumed: ${why.why}` : "";
    if (origin) field.box.dataset.origin = from ? "taken" : "assumed";
    else delete field.box.dataset.origin;
    if (origin) field.box.title = origin;
    else field.box.removeAttribute("title");
    say(field, "origin", [origin]);
  }
}

/** Lists the report. @param {HTMLElement} form @param {Start} start */
export function listImport(form, { report, title }) {
  if (!report) return;
  const { source, pair } = report;
  const by = source.application ? ` by ${source.application}` : "";
  byId("imported-source").textContent = `${title.replace(/^the model /, "")}: REXS ${source.version}${by}, ${pair.label}${pair.mirrored ? ", mirrored" : ""}`;
  const fields = new Map(fieldsOf(form).map((field) => [field.pointer, field]));
  const place = (pointer) => {
    const field = fields.get(pointer);
    return field ? linkTo(field) : el("code", {}, pointer);
  };
  list("imported-warnings", report.warnings, ({ pointer, detail }) => [...(pointer ? [place(pointer), " "] : []), detail]);
  list("imported-assumed", report.assumed, ({ pointer, value, unit, why }) => [place(pointer), ` ${valueText(value, unit)}: ${why}`]);
  list("imported-taken", report.taken, ({ pointer, value, unit, from, why }) => [place(pointer), ` ${valueText(value, unit)} from ${from}${why ? ` (${why})` : ""}`]);
  list("imported-ignored", report.ignored, ({ from, why, amount }) => [`${from}${amount ? ` = ${amount}` : ""}: ${why}`]);
  list("imported-checks", report.checks, ({ name, file, ours, unit, agrees }) => [
    `${name}: ${number(file, 7)} in the file, ${number(ours, 7)} ${unit ?? ""} here${agrees ? "" : ": they differ"}`,
  ]);
}

/**
 * Fills a list under its heading, which has the number of lines; without lines it is not shown.
 * @template Line
 * @param {"imported-warnings" | "imported-assumed" | "imported-taken" | "imported-ignored" | "imported-checks"} id
 * @param {Line[]} lines
 * @param {(line: Line) => Child[]} content
 */
function list(id, lines, content) {
  const box = byId(id);
  show(box, lines.length > 0);
  box.open = (id === "imported-warnings" || id === "imported-assumed") && lines.length <= MOST_OPEN;
  const [summary, items] = [box.querySelector("summary span"), box.querySelector("ul")];
  summary?.replaceChildren(String(lines.length));
  items?.replaceChildren(...lines.map((line) => el("li", {}, ...content(line))));
}

/** @param {unknown} value @param {string | null | undefined} unit */
function valueText(value, unit) {
  if (value === null || value === undefined) return "left open";
  if (typeof value === "number") return [number(value, 7), shownUnit(unit ?? "")].filter(Boolean).join(" ");
  if (Array.isArray(value)) return `${value.length} entries`;
  return typeof value === "object" ? "a group" : String(value);
}
