// Tools below a plot: its data as text, as a table and as files.

import { csvOf } from "./csv.js";
import { download, el, fillRows } from "./dom.js";
import { number } from "./format.js";
import { parts } from "./plot_style.js";

/** Rows of the table below a plot; the file has all. */
const MAX_ROWS = 500;

/** Puts the tools below the box. `current` returns the plot's data, `picture` makes an image of it. */
export function toolsOf(node, current, picture) {
  const head = el("thead");
  const table = el("table", { class: "numbers" }, el("caption", { class: "visually-hidden" }), head, el("tbody"));
  const sentence = el("p", { class: "help" });
  const details = el("details", {}, el("summary", {}, "Data"), sentence, el("div", { class: "scroll", tabIndex: 0, role: "region" }, table));
  details.addEventListener("toggle", () => details.open && fill());
  const button = (text, title, act) => {
    const made = el("button", { type: "button", class: "quiet", title }, text);
    made.addEventListener("click", act);
    return made;
  };
  const save = async (format, type, decode) => download(`${fileName(current())}.${format}`, decode(await picture(format)), type);
  const buttons = [
    button("CSV", "Save the numbers of this plot", () => download(`${fileName(current())}.csv`, csv(current()), "text/csv;charset=utf-8")),
    button("PNG", "Save this plot as an image", () => save("png", "image/png", bytes)),
    button("SVG", "Save this plot as a drawing", () => save("svg", "image/svg+xml", (text) => text)),
  ];
  const bar = el("div", { class: "plot-tools" }, details, el("div", { class: "plot-files", role: "group" }, ...buttons));
  node.after(bar);
  const fill = () => {
    const { names, rows } = tableOf(current());
    head.replaceChildren(el("tr", {}, ...names.map((name) => el("th", { scope: "col" }, name))));
    fillRows(table.tBodies[0], rows.slice(0, MAX_ROWS).map((row) => row.map((value) => (value === null || value === undefined ? "" : number(value, 6)))));
    const more = rows.length > MAX_ROWS ? ` The first ${MAX_ROWS} of ${number(rows.length)} rows; the CSV file has all.` : "";
    sentence.textContent = summary(current()) + more;
  };
  return { bar, details, buttons, table, fill };
}

/** Gives the plot and its tools their names, and the table its new content. */
export function describe(figure) {
  const { node, axes, tools } = figure;
  const name = nameOf(figure);
  const text = summary(figure);
  node.setAttribute("aria-label", `${name}: ${parts(axes.y).label || parts(axes.y).unit} over ${parts(axes.x).label || parts(axes.x).unit}. ${text}`);
  tools.table.caption.textContent = name;
  tools.table.parentElement.setAttribute("aria-label", `Data of: ${name}`);
  tools.bar.lastElementChild.setAttribute("aria-label", `Save: ${name}`);
  for (const button of tools.buttons) button.setAttribute("aria-label", `${button.textContent} of: ${name}`);
  if (tools.details.open) tools.fill();
}

/** What the page is about: the job's name, or that of the comparison. */
const subject = () => /** @type {HTMLElement | null} */ (document.querySelector("[data-subject]"))?.dataset.subject ?? document.querySelector("h1")?.textContent?.trim() ?? "";

/** Letters of a line of a title at most. */
const MAX_TITLE = 110;

/** A text as plotly shows it as it is. @param {string} text */
const plain = (text) => (text.length > MAX_TITLE ? `${text.slice(0, MAX_TITLE)}…` : text).replaceAll("&", "&amp;").replaceAll("<", "&lt;");

/** The axes of an image that stands for itself: with its title, the job, and the quantity beside the unit. */
export function axesOfFile(figure) {
  const { axes } = figure;
  const name = nameOf(figure);
  const about = axes.subject ?? subject();
  const { label, unit } = parts(axes.y);
  const title = [plain(name), about ? `<sup>${plain(about)}</sup>` : ""].filter(Boolean).join("<br>");
  return { ...axes, title, y: label || !unit ? axes.y : { label: axes.quantity ?? name, unit } };
}

function nameOf({ node, axes }) {
  const caption = node.closest("figure")?.querySelector("figcaption") ?? node.closest("section")?.querySelector("h2");
  return axes.name ?? axes.title ?? caption?.textContent ?? "Plot";
}

function fileName(figure) {
  const words = (figure.axes.csvName ?? nameOf(figure)).toLowerCase().replace(/[^a-z0-9]+/g, "-").replace(/^-|-$/g, "");
  const job = /** @type {HTMLElement | null} */ (document.querySelector("[data-id]"))?.dataset.id;
  return job ? `${words}-${job.slice(-8)}` : words;
}

const isMap = ({ type }) => type === "heatmap" || type === "contour";

const shownTraces = ({ traces }) => traces.filter((trace) => !trace.aside);

/** Least and greatest value of each trace, and where they are. */
export function summary(figure) {
  const { axes } = figure;
  const x = parts(axes.x);
  return shownTraces(figure)
    .map((trace) => {
      const { unit } = isMap(trace) ? trace : parts(trace.yaxis === "y2" ? axes.y2 : axes.y);
      const values = (isMap(trace) ? trace.z.flat() : trace.y ?? []).map((value, index) => [value, index]).filter(([value]) => typeof value === "number");
      if (!values.length) return "";
      const [low, high] = [values.reduce((a, b) => (b[0] < a[0] ? b : a)), values.reduce((a, b) => (b[0] > a[0] ? b : a))];
      const at = ([, index]) => (isMap(trace) ? "" : ` at ${shown(trace.x[index])}${x.unit ? ` ${x.unit}` : ""}`);
      const name = trace.name ? `${trace.name}: ` : "";
      return `${name}from ${number(low[0], 4)}${at(low)} to ${number(high[0], 4)} ${unit ?? ""}${at(high)}.`.replace(" .", ".");
    })
    .filter(Boolean)
    .join(" ");
}

const shown = (value) => (typeof value === "number" ? number(value, 4) : String(value));

/**
 * Columns of what is drawn: traces over the same places share the first, others have their own. A heat map is a list
 * of its cells.
 */
function tableOf(figure) {
  const { axes } = figure;
  const [x, y] = [parts(axes.x), parts(axes.y)];
  const head = ({ label, unit }, name = "") => [[label, name].filter(Boolean).join(" ") || nameOf(figure), unit ? `[${unit}]` : ""].filter(Boolean).join(" ");
  const traces = shownTraces(figure);
  const maps = traces.filter(isMap);
  if (maps.length) {
    const rows = maps.flatMap((map) => map.z.flatMap((row, at) => row.map((value, column) => [map.x[column], map.y[at], value])));
    return { names: [head(x), head(y), head({ label: axes.z ?? nameOf(figure), unit: maps[0].unit })], rows };
  }
  const columns = [];
  let places = null;
  for (const band of axes.bands ?? []) {
    columns.push([head(x, band.name), band.x], [head(y, `${band.name ?? ""} least`.trim()), band.low], [head(y, `${band.name ?? ""} greatest`.trim()), band.high]);
  }
  for (const trace of traces) {
    if (!places || !same(places, trace.x)) columns.push([head(x, places ? trace.name : ""), trace.x]);
    places ??= trace.x;
    columns.push([head(trace.yaxis === "y2" ? parts(axes.y2) : y, trace.name), trace.y]);
  }
  const length = Math.max(0, ...columns.map(([, values]) => values.length));
  return { names: columns.map(([name]) => name), rows: Array.from({ length }, (_, row) => columns.map(([, values]) => values[row])) };
}

const same = (a, b) => a === b || (a.length === b.length && a.every((value, index) => value === b[index]));

/** The numbers as a file. */
export function csv(figure) {
  const { names, rows } = tableOf(figure);
  return csvOf([names, ...rows]);
}

function bytes(base64) {
  return Uint8Array.from(atob(base64), (sign) => sign.charCodeAt(0));
}
