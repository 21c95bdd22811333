// Small helpers for building the page. Text goes in as text nodes only: nothing from a job is ever read as HTML.

export const byId = (id) => document.getElementById(id);

/** An element with properties and children (strings become text). */
export function el(tag, properties = {}, ...children) {
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

export function show(node, visible = true) {
  node.hidden = !visible;
}

/** Fills a `dl` with [term, value, unit] rows; rows without a value are left out. */
export function fillValues(list, rows) {
  list.replaceChildren(
    ...rows
      .filter(([, value]) => value !== undefined && value !== null && value !== "")
      .map(([term, value, unit]) => el("div", {}, el("dt", {}, term), el("dd", {}, value, unit ? el("span", { class: "unit" }, ` ${unit}`) : null))),
  );
}

/** Fills a table body; each row is an array of cells (strings or nodes), the first of which heads the row. */
export function fillRows(body, rows) {
  body.replaceChildren(
    ...rows.map(([head, ...cells]) => el("tr", {}, el("th", { scope: "row" }, head), ...cells.map((cell) => el("td", {}, cell)))),
  );
}

/** Shows a failure in a notice, or hides the notice when there is none. */
export function notify(node, error) {
  show(node, Boolean(error));
  if (!error) return;
  const problem = error.problem ?? { title: String(error.message ?? error) };
  const details = (problem.errors ?? []).map((entry) => el("li", {}, [entry.pointer, entry.detail].filter(Boolean).join(" ")));
  node.replaceChildren(
    el("strong", {}, problem.title ?? "The request failed"),
    problem.detail ? ` ${problem.detail}` : "",
    details.length ? el("ul", {}, ...details) : "",
    problem.request_id ? el("p", { class: "help" }, `Request ${problem.request_id}`) : "",
  );
}

/** Warnings of a check or a result. */
export function fillWarnings(list, warnings) {
  list.replaceChildren(
    ...(warnings ?? []).map((warning) =>
      el("li", {}, el("strong", {}, warning.code.replaceAll("-", " ")), " ", warning.detail, warning.pointer ? el("code", {}, ` ${warning.pointer}`) : null),
    ),
  );
}

export function download(name, text, type = "application/json") {
  const url = URL.createObjectURL(new Blob([text], { type }));
  const link = el("a", { href: url, download: name });
  document.body.append(link);
  link.click();
  link.remove();
  setTimeout(() => URL.revokeObjectURL(url), 10_000);
}
