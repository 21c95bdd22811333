// The two tables, side by side, and both as a file.

import { csvOf } from "../common/csv.js";
import { byId, download, el, show } from "../common/dom.js";
import { number } from "../common/format.js";
import { differing, shown } from "./inputs.js";
import { difference, groupsOf } from "./numbers.js";

/** Whether the values that belong to no group are shown. */
let areOthersShown = false;

/** @param {ComparedJob[]} jobs in their order @param {ComparedJob} reference one of them */
export function showTables(jobs, reference) {
  const known = jobs.filter(({ input }) => input);
  show(byId("inputs"), known.length > 1);
  if (known.length > 1) showInputs(known, reference);
  const groups = groupsOf(known);
  show(byId("numbers"), groups.length > 0);
  if (groups.length) showNumbers(groups, known, reference);
}

function head(table, first, jobs, reference) {
  table.querySelector("colgroup")?.remove();
  table.prepend(el("colgroup", {}, el("col", { class: "what" }), ...jobs.map(() => el("col")), el("col", { class: "unit" })));
  table.style.setProperty("--jobs", jobs.length);
  const cells = jobs.map((job) =>
    el("th", { scope: "col", class: job === reference ? "is-reference" : "" }, job.mark(), ` ${job.name}`, job === reference ? el("span", { class: "help" }, "reference") : null));
  table.tHead.replaceChildren(el("tr", {}, el("th", { scope: "col" }, first), ...cells, el("th", { scope: "col" }, "Unit")));
}

function showInputs(jobs, reference) {
  const { rows, total } = differing(jobs.map(({ input }) => input));
  byId("inputs-note").textContent = rows.length === 0 ? `All ${total} inputs are the same.` : `${rows.length} of ${total} inputs.`;
  const table = byId("inputs-table");
  show(table, rows.length > 0);
  head(table, "Input", jobs, reference);
  const at = jobs.indexOf(reference);
  table.tBodies[0].replaceChildren(
    ...rows.map(({ pointer, label, unit, values }) => {
      const texts = values.map(shown);
      const cells = texts.map((text, index) => el("td", { class: index === at ? "is-reference" : text === texts[at] ? "same" : "" }, text));
      return el("tr", { "data-pointer": pointer }, el("th", { scope: "row", title: pointer }, label), ...cells, el("td", {}, unit));
    }),
  );
}

function showNumbers(groups, jobs, reference) {
  const table = byId("numbers-table");
  head(table, "Quantity", jobs, reference);
  for (const body of Array.from(table.tBodies)) body.remove();
  const at = jobs.indexOf(reference);
  for (const { title, isFolded, rows } of groups) {
    const shownRows = rows.map((row) => numberRow(row, jobs, at));
    const name = el("span", {}, isFolded ? foldButton(title, shownRows) : title);
    const heading = el("tr", { class: "group-title" }, el("th", { scope: "rowgroup", colSpan: jobs.length + 2 }, name));
    table.append(el("tbody", {}, heading, ...shownRows));
  }
  const isMixed = new Set(jobs.map(({ job }) => job.kind)).size > 1;
  const said = (words, which) => (isMixed && jobs.some(which) ? `${words}: ${jobs.filter(which).map(({ letter }) => letter).join(", ")}.` : "");
  const missing = jobs.filter(({ result, sweep }) => !result && !sweep).map(({ letter }) => letter);
  byId("numbers-note").textContent = [
    at >= 0 && jobs.length > 1 ? `Differences are against ${reference.letter}.` : "",
    said("Of sweeps the largest values are compared", ({ job }) => job.kind === "sweep"),
    said("No vibration was asked for in", ({ job }) => job.kind === "mesh"),
    missing.length ? `Without a result: ${missing.join(", ")}.` : "",
  ].filter(Boolean).join(" ");
}

/** Rows that a button shows, for all tables from then on. @param {string} title @param {HTMLElement[]} rows */
function foldButton(title, rows) {
  const button = el("button", { type: "button", class: "quiet" });
  const update = () => {
    button.setAttribute("aria-expanded", String(areOthersShown));
    button.textContent = `${areOthersShown ? "−" : "+"} ${title} (${rows.length})`;
    rows.forEach((row) => show(row, areOthersShown));
  };
  button.addEventListener("click", () => {
    areOthersShown = !areOthersShown;
    update();
  });
  update();
  return button;
}

function numberRow({ name, label, unit, change, cells }, jobs, at) {
  const reference = cells[at]?.value;
  return el(
    "tr",
    { "data-name": name },
    el("th", { scope: "row" }, ...withSubscripts(label)),
    ...cells.map(({ value, at: place }, index) => {
      const by = index === at ? "" : difference(value, reference, change, unit);
      const where = place ? el("span", { class: "where" }, place) : null;
      return el("td", { "data-job": jobs[index].id, class: index === at ? "is-reference" : "" }, el("span", { class: "value" }, number(value)), where, by ? el("span", { class: "by" }, by) : null);
    }),
    el("td", {}, unit),
  );
}

/** Symbols as in ISO 21771: an underscore begins a subscript. */
function withSubscripts(label) {
  return label.split(/(_[^\s,]+)/).map((part) => (part.startsWith("_") ? el("sub", {}, part.slice(1)) : part));
}

/** Both tables with every digit; RFC 4180. */
export function saveTables(jobs, reference) {
  const known = jobs.filter(({ input }) => input);
  const at = known.indexOf(reference);
  const others = known.filter((job) => job !== reference);
  const names = [...known.map(({ letter, name }) => `${letter} ${name}`), ...(at < 0 ? [] : others.map(({ letter }) => `${letter} against ${reference.letter} [%]`))];
  const lines = [["part", "quantity", "unit", ...names], ["job", "id", "", ...known.map(({ id }) => id), ...(at < 0 ? [] : others.map(() => ""))]];
  const raw = (value) => (value !== null && typeof value === "object" ? JSON.stringify(value) : value);
  for (const { pointer, unit, values } of differing(known.map(({ input }) => input)).rows) lines.push(["input", pointer, unit, ...values.map(raw), ...percents(values, at)]);
  for (const { title, rows } of groupsOf(known)) {
    for (const { label, unit, cells } of rows) {
      const values = cells.map(({ value }) => value);
      lines.push([title, label, unit, ...values, ...percents(values, at)]);
    }
  }
  download("comparison.csv", csvOf(lines), "text/csv;charset=utf-8");
}

function percents(values, at) {
  if (at < 0) return [];
  const reference = values[at];
  const others = values.filter((_, index) => index !== at);
  return others.map((value) => (typeof value === "number" && typeof reference === "number" && reference !== 0 ? (100 * (value - reference)) / Math.abs(reference) : ""));
}
