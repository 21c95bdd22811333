// Shows the server's violations at the fields they are about.

import { byId, el, show } from "../common/dom.js";
import { fieldAt, fieldsOf } from "./document.js";

export function clearErrors(form) {
  for (const field of fieldsOf(form)) {
    field.error.textContent = "";
    field.input.removeAttribute("aria-invalid");
  }
  show(byId("problems"), false);
}

/** Marks the fields named in the error; `summary` also lists everything at the top and goes there. */
export function showErrors(form, error, { summary }) {
  clearErrors(form);
  const fields = fieldsOf(form);
  const entries = (error.errors ?? []).map((entry) => ({ ...entry, field: fieldAt(fields, entry.pointer ?? "") }));
  for (const { field, pointer, detail } of entries) {
    if (!field) continue;
    const place = field.pointer === pointer ? "" : `${pointer.slice(field.pointer.length + 1)}: `;
    field.error.append(field.error.textContent ? `; ${place}${detail}` : `${place}${detail}`);
    field.input.setAttribute("aria-invalid", "true");
    field.box.closest("details").open = true;
  }
  const nowhere = entries.filter(({ field }) => !field);
  if (summary || nowhere.length || entries.length === 0) {
    listProblems(error, summary ? entries : nowhere);
    if (summary) byId("problems").focus();
  }
}

function listProblems(error, entries) {
  const box = byId("problems");
  const items = entries.map(({ field, pointer, detail }) => {
    const text = [pointer, detail].filter(Boolean).join(" ");
    if (!field) return el("li", {}, text);
    const label = field.box.querySelector("label").firstChild.textContent.trim();
    const link = el("a", { href: `#${field.input.id}` }, label);
    link.addEventListener("click", (event) => {
      event.preventDefault();
      field.box.closest("details").open = true;
      field.input.focus();
    });
    return el("li", {}, link, ` ${detail}`);
  });
  box.replaceChildren(
    el("strong", {}, error.problem?.title ?? error.message),
    error.problem?.detail ? ` ${error.problem.detail}` : "",
    items.length ? el("ul", {}, ...items) : "",
  );
  show(box);
}
