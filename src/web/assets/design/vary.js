// Variables of an optimisation, out of the fields of the form: "Vary this" at every number, and the list of those that
// vary, with their bounds.

import { byId, el, show } from "../common/dom.js";
import { pointerLabel } from "../common/format.js";
import { readDocument, setExtra } from "./document.js";

/** Parts of the document in which inputs can vary, and the most that can. */
const PARTS = ["/design/", "/operation/", "/model/"];
const MOST = 12;
/** Bounds of an input that has no value. */
const FREE = [0, 10];

/** Bounds about a value: half and one and a half times it. @param {unknown} value */
function boundsOf(value) {
  const number = typeof value === "number" ? value : Number.NaN;
  return number ? [0.5 * number, 1.5 * number].sort((a, b) => a - b) : FREE;
}

/**
 * Sets the list up. `changed()` tells the form that the document was changed by a script.
 * @param {HTMLFormElement} form
 * @param {() => void} changed
 */
export function initVary(form, changed) {
  const kind = /** @type {HTMLSelectElement | null} */ (form.querySelector("[data-pointer='/kind'] select"));
  const section = byId("vary");
  const variables = () => readDocument(form).variables ?? [];
  const set = (list) => {
    setExtra("/variables", list);
    changed();
    update();
  };

  /** @param {HTMLElement} box */
  function add(box) {
    const pointer = box.dataset.pointer ?? "";
    const input = /** @type {HTMLInputElement} */ (box.querySelector("input"));
    const [from, to] = boundsOf(Number.parseFloat(input.value || (box.dataset.default ?? "")));
    set([...variables(), { pointer, from, to }]);
    /** @type {HTMLElement | null} */ (byId("vary-rows").querySelector("tr:last-child input"))?.focus();
  }

  /** Buttons at the fields of numbers, while an optimisation is written. */
  function buttons() {
    const isOn = kind?.value === "optimise";
    for (const box of /** @type {NodeListOf<HTMLElement>} */ (form.querySelectorAll("[data-control='number'], [data-control='integer']"))) {
      const pointer = box.dataset.pointer ?? "";
      if (!PARTS.some((part) => pointer.startsWith(part))) continue;
      const old = box.querySelector(".vary");
      const has = variables().some((variable) => variable.pointer === pointer || variable.also?.includes(pointer));
      if (!isOn || has) old?.remove();
      else if (!old) {
        const { label } = pointerLabel(pointer);
        const button = el("button", { type: "button", class: "vary quiet", title: "Vary this in the search" }, "↔");
        button.setAttribute("aria-label", `Vary ${label}`);
        button.addEventListener("click", () => add(box));
        box.querySelector(".input")?.append(button);
      }
    }
  }

  /**
   * @param {{ pointer: string, also?: string[], from: number, to: number, step?: number | null }} variable
   * @param {number} place
   */
  function row(variable, place) {
    const { label, unit } = pointerLabel(variable.pointer);
    const bound = (name, what) => {
      const input = el("input", { type: "text", inputMode: "decimal", value: String(variable[name] ?? "") });
      input.setAttribute("aria-label", `${label}: ${what}`);
      input.addEventListener("change", () => {
        const number = Number.parseFloat(input.value.replace(",", "."));
        const { [name]: _old, ...rest } = variables()[place];
        const changedOne = Number.isFinite(number) ? { ...rest, [name]: number } : rest;
        set(variables().map((one, index) => (index === place ? changedOne : one)));
      });
      return el("td", {}, input);
    };
    const remove = el("button", { type: "button", class: "quiet" }, "×");
    remove.setAttribute("aria-label", `Do not vary ${label}`);
    remove.addEventListener("click", () => set(variables().filter((_one, index) => index !== place)));
    const also = variable.also?.length ? ` and ${variable.also.map((pointer) => pointerLabel(pointer).label).join(", ")}` : "";
    return el("tr", {}, el("th", { scope: "row" }, `${label}${also}${unit ? `, ${unit}` : ""}`), bound("from", "from"), bound("to", "to"), bound("step", "step"), el("td", {}, remove));
  }

  function update() {
    const isOn = kind?.value === "optimise";
    show(section, isOn);
    buttons();
    if (!isOn) return;
    const list = variables();
    byId("vary-note").textContent = list.length ? "" : "Choose what varies: ↔ at a number of the pair, the operation or the model.";
    if (list.length > MOST) byId("vary-note").textContent = `At most ${MOST} inputs can vary.`;
    const rows = byId("vary-rows");
    if (rows.contains(document.activeElement) && rows.childElementCount === list.length) return;
    rows.replaceChildren(...list.map(row));
  }
  // The text of the document follows every change of the form, those by scripts too.
  new MutationObserver(update).observe(byId("document-text"), { childList: true, characterData: true, subtree: true });
  update();
}
