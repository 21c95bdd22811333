// The window in which name, label and notes of a job are changed.

import * as api from "./api.js";
import { el, notify } from "./dom.js";

/** Fields with their label and the most characters they take. @type {["name" | "label" | "notes", string, number][]} */
const FIELDS = [["name", "Name", 200], ["label", "Label", 100], ["notes", "Notes", 5000]];

/**
 * Opens the window. Gives the changed job, or null when nothing was changed.
 * @param {Job} job
 * @returns {Promise<Job | null>}
 */
export function describeJob(job) {
  const inputs = FIELDS.map(([name, label, most]) => {
    const value = job[name] ?? "";
    const common = { id: `describe-${name}`, value, maxLength: most };
    const input = name === "notes" ? el("textarea", { ...common, rows: 6 }) : el("input", { ...common, type: "text" });
    return { name, input, row: el("p", {}, el("label", { htmlFor: input.id }, label), input) };
  });
  const problem = el("p", { class: "notice bad", role: "alert", hidden: true });
  const title = el("h2", { id: "describe-title" }, "Name, label and notes");
  const keep = el("button", { type: "button" }, "Cancel");
  const save = el("button", { type: "submit", class: "primary" }, "Save");
  const form = el("form", { class: "describe" }, title, ...inputs.map(({ row }) => row), problem, el("p", { class: "actions" }, keep, save));
  const dialog = el("dialog", {}, form);
  dialog.setAttribute("aria-labelledby", title.id);
  /** @type {Job | null} */
  let changed = null;

  async function send() {
    const patch = Object.fromEntries(inputs.flatMap(({ name, input }) => {
      const text = input.value.trim();
      return text === (job[name] ?? "") ? [] : [[name, text === "" ? null : text]];
    }));
    if (Object.keys(patch).length === 0) return dialog.close();
    save.disabled = true;
    try {
      changed = await api.update(job.id, patch);
      dialog.close();
    } catch (error) {
      notify(problem, error);
      save.disabled = false;
    }
  }

  form.addEventListener("submit", (event) => {
    event.preventDefault();
    send();
  });
  keep.addEventListener("click", () => dialog.close());
  document.body.append(dialog);
  dialog.showModal();
  inputs[0].input.focus();
  return new Promise((resolve) => {
    dialog.addEventListener("close", () => {
      dialog.remove();
      resolve(changed);
    }, { once: true });
  });
}
