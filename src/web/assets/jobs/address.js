// Filters, order and page of the list in the address, so that it can be shared and the history of the browser works.

import { byId } from "../common/dom.js";

export const PAGE_SIZES = [25, 50, 100, 200];
const [DEFAULT_SIZE] = PAGE_SIZES;
/** Order of the list without another one in the address. */
export const NEWEST = "submitted-desc";

const form = byId("filters");
const states = /** @type {RadioNodeList} */ (form.elements.namedItem("state"));
const boxes = () => [...states].map((box) => /** @type {HTMLInputElement} */ (box));
const kind = byId("filter-kind");
const sort = byId("sort");
const limit = byId("page-size");
/** Inputs of texts and days, by their names in the address. */
const inputs = { label: byId("filter-label"), search: byId("filter-search"), from: byId("filter-from"), to: byId("filter-to") };
const NAMES = /** @type {(keyof typeof inputs)[]} */ (Object.keys(inputs));

/** Whether an input is one of those that people type into. @param {EventTarget | null} target */
export const isTyped = (target) => target === inputs.label || target === inputs.search;
export const label = inputs.label;

/** @param {HTMLSelectElement} select @param {string | null} given @param {string} fallback */
const known = (select, given, fallback) => ([...select.options].some((option) => option.value === given) ? String(given) : fallback);
/** @param {string | null} given */
const day = (given) => (/^\d{4}-\d\d-\d\d$/.test(given ?? "") ? String(given) : "");

/** The view that the address names; unknown words are left out. @returns {ListView} */
export function read() {
  const given = new URLSearchParams(window.location.search);
  const words = boxes().map((box) => box.value);
  return {
    states: (given.get("state") ?? "").split(",").filter((state) => words.includes(state)),
    kind: known(kind, given.get("kind"), ""),
    label: given.get("label") ?? "",
    search: given.get("search") ?? "",
    from: day(given.get("from")),
    to: day(given.get("to")),
    sort: known(sort, given.get("sort"), NEWEST),
    limit: Number(known(limit, given.get("limit"), String(DEFAULT_SIZE))),
    cursor: given.get("cursor") ?? "",
    trail: window.history.state?.trail ?? null,
  };
}

/**
 * Puts a view of the list into the address, as an entry of its own in the history or in place of the present one.
 * @param {ListView} view
 * @param {boolean} isStep
 */
export function write(view, isStep) {
  const { states, kind, label, search, from, to, sort, limit, cursor } = view;
  const all = { state: states.join(","), kind, label, search, from, to, sort: sort === NEWEST ? "" : sort, limit: limit === DEFAULT_SIZE ? "" : String(limit), cursor };
  const given = Object.entries(all).filter(([, value]) => value);
  const query = given.map(([name, value]) => `${name}=${encodeURIComponent(value).replaceAll("%2C", ",").replaceAll("%20", "+")}`).join("&");
  const address = window.location.pathname + (query ? `?${query}` : "");
  window.history[isStep ? "pushState" : "replaceState"]({ trail: view.trail }, "", address);
}

/** Filters, order and page size of the form, on the first page. @returns {ListView} */
export function readForm() {
  return {
    states: boxes().filter((box) => box.checked).map((box) => box.value),
    kind: kind.value,
    label: inputs.label.value.trim(),
    search: inputs.search.value.trim(),
    from: inputs.from.value,
    to: inputs.to.value,
    sort: sort.value,
    limit: Number(limit.value),
    cursor: "",
    trail: [],
  };
}

/** Shows a view's filters and order in the form. @param {ListView} view */
export function fillForm(view) {
  for (const box of boxes()) box.checked = view.states.includes(box.value);
  kind.value = view.kind;
  for (const name of NAMES) if (inputs[name].value.trim() !== view[name]) inputs[name].value = view[name];
  sort.value = view.sort;
  limit.value = String(view.limit);
}

/** @param {ListView} view */
export const isFiltered = ({ states, kind, label, search, from, to }) => states.length > 0 || [kind, label, search, from, to].some(Boolean);

/** A view without its filters, on the first page. @param {ListView} view @returns {ListView} */
export const withoutFilters = (view) => ({ ...view, states: [], kind: "", label: "", search: "", from: "", to: "", cursor: "", trail: [] });

/** The parameters of the request for a view. @param {ListView} view */
export function parameters({ states, kind, label, search, from, to, sort, limit, cursor }) {
  const [by, order] = sort.split("-");
  return { limit, state: states.join(","), kind, label, search, from: instantOf(from, 0), to: instantOf(to, 1), sort: by, order, cursor };
}

/**
 * The instant at which a day of the local calendar begins, or the one so many days later.
 * @param {string} text
 * @param {number} later
 */
function instantOf(text, later) {
  if (!text) return "";
  const [year, month, date] = text.split("-").map(Number);
  return new Date(year, month - 1, date + later).toISOString();
}

/** Whether a job belongs to the list as filtered. @param {Job} job @param {ListView} view */
export function fits(job, { states, kind, label, search, from, to }) {
  const found = search.toLowerCase();
  const submitted = Date.parse(job.submitted_at);
  return (!states.length || states.includes(job.state))
    && (!kind || job.kind === kind)
    && (!label || job.label === label)
    && (!search || [job.name, job.label, job.notes].some((text) => text?.toLowerCase().includes(found)))
    && (!from || submitted >= Date.parse(instantOf(from, 0)))
    && (!to || submitted < Date.parse(instantOf(to, 1)));
}
