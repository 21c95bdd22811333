// Building and filling elements. Text goes in as text nodes only: nothing from a job is ever read as HTML.

import { codeWords, placeOf, readable } from "./sentence.js";

/**
 * The element of the page's template with this id.
 * @template {keyof TemplateElements} Id
 * @param {Id} id
 * @returns {TemplateElements[Id]}
 */
export const byId = (id) => byAnyId(id);

/**
 * The element with an id that is put together at run time; its kind is known to the caller.
 * @param {string} id
 * @returns {any}
 */
export const byAnyId = (id) => document.getElementById(id);

/** The first body of a table. @param {HTMLElement} table */
export const bodyOf = (table) => /** @type {HTMLTableElement} */ (table).tBodies[0];

/**
 * An element with properties or attributes, and children (strings become text).
 * @template {keyof HTMLElementTagNameMap} Tag
 * @param {Tag} tag
 * @param {Record<string, any>} [properties]
 * @param {Child[]} children
 * @returns {HTMLElementTagNameMap[Tag]}
 */
export function el(tag, properties = {}, ...children) {
  /** @type {any} */
  const node = document.createElement(tag);
  for (const [name, value] of Object.entries(properties)) {
    if (value === undefined || value === null || value === false) continue;
    if (name === "class") node.className = value;
    else if (name in node) node[name] = value;
    else node.setAttribute(name, value);
  }
  node.append(...children.filter((child) => child !== null && child !== undefined));
  return node;
}

/**
 * Shows or hides an element.
 * @param {{ hidden: boolean | string }} node
 * @param {boolean} [visible]
 */
export function show(node, visible = true) {
  node.hidden = !visible;
}

/**
 * Shows or hides the figure that a plot's box is in.
 * @param {Element} box
 * @param {boolean} visible
 */
export const showFigureOf = (box, visible) => show(/** @type {HTMLElement} */ (box.closest("figure")), visible);

/**
 * A "?" that opens to the meaning of a number, with a link to its formula, source and validity in the help.
 * @param {string} name
 * @param {Explained} explained
 */
export function tip(name, { help, theory }) {
  const summary = el("summary", { title: help || "What is this?" }, "?");
  summary.setAttribute("aria-label", `What is: ${name}?`);
  const link = theory ? el("a", { href: `/help/theory/${theory}` }, "Formula, source, validity") : null;
  link?.setAttribute("aria-label", `Formula, source, validity: ${name}`);
  const details = el("details", { class: "tip" }, summary, el("p", {}, help, help && link ? " " : "", link));
  details.addEventListener("keydown", (event) => {
    if (event.key === "Escape") details.open = false;
  });
  details.addEventListener("focusout", (event) => {
    if (!details.contains(/** @type {Node | null} */ (event.relatedTarget))) details.open = false;
  });
  return details;
}

/**
 * A name that leads to formula, source and validity of its number.
 * @param {import("./quantities.js").Quantity} scalar
 * @param {Child} [shown]
 */
export const theoryLink = ({ label, pointer, theory }, shown = label) => el("a", { href: `/help/theory/${theory}`, title: pointer }, shown);

/**
 * Fills a `dl` with [term, value, unit, meaning] rows; rows without a value are left out.
 * @param {HTMLElement} list
 * @param {ValueRow[]} rows
 */
export function fillValues(list, rows) {
  list.replaceChildren(
    ...rows
      .filter(([, value]) => value !== undefined && value !== null && value !== "")
      .map(([term, value, unit, meaning]) => el("div", {}, el("dt", {}, term, meaning ? " " : "", meaning ? tip(term instanceof Node ? (term.textContent ?? "") : String(term), meaning) : null), el("dd", {}, value, unit ? el("span", { class: "unit" }, ` ${unit}`) : null))),
  );
}

/**
 * Fills a table body; each row is an array of cells (strings or nodes), the first of which heads the row.
 * @param {HTMLTableSectionElement} body
 * @param {Child[][]} rows
 */
export function fillRows(body, rows) {
  body.replaceChildren(
    ...rows.map(([head, ...cells]) => el("tr", {}, el("th", { scope: "row" }, head), ...cells.map((cell) => el("td", {}, cell)))),
  );
}

/**
 * Shows a failure in a notice, or hides the notice when there is none.
 * @param {HTMLElement} node
 * @param {any} error
 */
export function notify(node, error) {
  show(node, Boolean(error));
  if (!error) return;
  /** @type {ProblemBody} */
  const problem = error.problem ?? { title: String(error.message ?? error) };
  const details = (problem.errors ?? []).map((entry) => el("li", {}, [placeOf(entry.pointer), readable(entry.detail)].filter(Boolean).join(" ")));
  node.replaceChildren(
    el("strong", {}, problem.title ?? "The request failed"),
    problem.detail ? ` ${readable(problem.detail)}` : "",
    details.length ? el("ul", {}, ...details) : "",
    problem.request_id ? el("p", { class: "help" }, `Request ${problem.request_id}`) : "",
  );
}

/**
 * Fills a list with the warnings of a check or a result.
 * @param {HTMLElement} list
 * @param {WarningEntry[] | null | undefined} warnings
 */
export function fillWarnings(list, warnings) {
  list.replaceChildren(
    ...(warnings ?? []).map((warning) =>
      el("li", {}, el("strong", {}, codeWords(warning.code)), ` ${readable(warning.detail)}`, warning.pointer ? el("span", { class: "muted" }, ` (${placeOf(warning.pointer)})`) : null),
    ),
  );
}

/**
 * Saves a file under a name.
 * @param {string} name
 * @param {string | Blob} text
 * @param {string} [type] media type
 */
export function download(name, text, type = "application/json") {
  const url = URL.createObjectURL(new Blob([text], { type }));
  const link = el("a", { href: url, download: name });
  document.body.append(link);
  link.click();
  link.remove();
  setTimeout(() => URL.revokeObjectURL(url), 10_000);
}
