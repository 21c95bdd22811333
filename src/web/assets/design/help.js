// Help: a line at the bottom of the window for the field in use, and a disclosure beside each field.

import { byAnyId, byId } from "../common/dom.js";

/** @param {HTMLFormElement} form */
export function initHelp(form) {
  const line = byId("help-line");
  form.addEventListener("focusin", (event) => {
    const box = /** @type {Element} */ (event.target).closest("[data-pointer]");
    line.classList.toggle("busy", box !== null);
    if (box) line.textContent = about(box);
  });
  form.addEventListener("focusout", () => line.classList.remove("busy"));
  form.addEventListener("click", (event) => {
    const button = /** @type {Element} */ (event.target).closest(".why");
    if (!button) return;
    const open = button.getAttribute("aria-expanded") !== "true";
    button.setAttribute("aria-expanded", String(open));
    byAnyId(button.getAttribute("aria-controls") ?? "").hidden = !open;
  });
}

/** Name, help, range and default of a field in one line. @param {Element} box */
function about(box) {
  const parts = (box.querySelector("[aria-describedby]")?.getAttribute("aria-describedby") ?? "").split(" ").map(byAnyId);
  const texts = parts.filter((node) => node?.matches(".help, .range")).map((node) => node.textContent.trim()).filter(Boolean);
  const name = box.querySelector("label")?.textContent?.trim() ?? "";
  return `${name}: ${texts.join(" · ")}`;
}
