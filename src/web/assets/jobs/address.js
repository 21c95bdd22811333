// The filters and the page of the list stand in the address: it can be shared, and back and forward work.

import { byId } from "../common/dom.js";

const form = byId("filters");
const boxes = () => [...form.elements.namedItem("state")];

/** What the address asks for; words that mean nothing here are left out. */
export function read() {
  const given = new URLSearchParams(window.location.search);
  const known = boxes().map((box) => box.value);
  const kinds = [...form.elements.kind.options].map((option) => option.value);
  return {
    states: (given.get("state") ?? "").split(",").filter((state) => known.includes(state)),
    kind: kinds.includes(given.get("kind")) ? given.get("kind") : "",
    label: given.get("label") ?? "",
    cursor: given.get("cursor") ?? "",
    // The cursors of the pages before this one, as far as they were walked through.
    trail: window.history.state?.trail ?? null,
  };
}

/** Puts a view of the list into the address; as a step of its own, or in place of the present one. */
export function write(view, isStep) {
  const { states, kind, label, cursor } = view;
  const given = Object.entries({ state: states.join(","), kind, label, cursor }).filter(([, value]) => value);
  const search = given.map(([name, value]) => `${name}=${encodeURIComponent(value).replaceAll("%2C", ",").replaceAll("%20", "+")}`).join("&");
  const address = window.location.pathname + (search ? `?${search}` : "");
  window.history[isStep ? "pushState" : "replaceState"]({ trail: view.trail }, "", address);
}

/** The filters that the form shows, on the first page. */
export function readForm() {
  return {
    states: boxes().filter((box) => box.checked).map((box) => box.value),
    kind: form.elements.kind.value,
    label: form.elements.label.value.trim(),
    cursor: "",
    trail: [],
  };
}

export function fillForm({ states, kind, label }) {
  for (const box of boxes()) box.checked = states.includes(box.value);
  form.elements.kind.value = kind;
  if (form.elements.label.value.trim() !== label) form.elements.label.value = label;
}

export const isFiltered = ({ states, kind, label }) => states.length > 0 || kind !== "" || label !== "";

/** Whether a job belongs to the list as filtered. */
export const fits = (job, { states, kind, label }) =>
  (!states.length || states.includes(job.state)) && (!kind || job.kind === kind) && (!label || job.label === label);
