// Filters and page of the list in the address, so that it can be shared and the history of the browser works.

import { byId } from "../common/dom.js";

const form = byId("filters");
const states = /** @type {RadioNodeList} */ (form.elements.namedItem("state"));
const boxes = () => [...states].map((box) => /** @type {HTMLInputElement} */ (box));
const kind = /** @type {HTMLSelectElement} */ (form.elements.namedItem("kind"));
export const label = /** @type {HTMLInputElement} */ (form.elements.namedItem("label"));

/** The view that the address names; unknown words are left out. @returns {ListView} */
export function read() {
  const given = new URLSearchParams(window.location.search);
  const known = boxes().map((box) => box.value);
  const kinds = [...kind.options].map((option) => option.value);
  const givenKind = given.get("kind") ?? "";
  return {
    states: (given.get("state") ?? "").split(",").filter((state) => known.includes(state)),
    kind: kinds.includes(givenKind) ? givenKind : "",
    label: given.get("label") ?? "",
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
  const { states, kind, label, cursor } = view;
  const given = Object.entries({ state: states.join(","), kind, label, cursor }).filter(([, value]) => value);
  const search = given.map(([name, value]) => `${name}=${encodeURIComponent(value).replaceAll("%2C", ",").replaceAll("%20", "+")}`).join("&");
  const address = window.location.pathname + (search ? `?${search}` : "");
  window.history[isStep ? "pushState" : "replaceState"]({ trail: view.trail }, "", address);
}

/** The filters of the form, on the first page. @returns {ListView} */
export function readForm() {
  return {
    states: boxes().filter((box) => box.checked).map((box) => box.value),
    kind: kind.value,
    label: label.value.trim(),
    cursor: "",
    trail: [],
  };
}

/** Shows a view's filters in the form. @param {ListView} view */
export function fillForm(view) {
  for (const box of boxes()) box.checked = view.states.includes(box.value);
  kind.value = view.kind;
  if (label.value.trim() !== view.label) label.value = view.label;
}

/** @param {ListView} view */
export const isFiltered = ({ states, kind, label }) => states.length > 0 || kind !== "" || label !== "";

/** Whether a job belongs to the list as filtered. @param {Job} job @param {ListView} view */
export const fits = (job, { states, kind, label }) =>
  (!states.length || states.includes(job.state)) && (!kind || job.kind === kind) && (!label || job.label === label);
