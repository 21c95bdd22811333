// A box that finds an entry by parts of its name: a combobox with a grouped list after the WAI-ARIA pattern.

import { el, show } from "../common/dom.js";

/** Entries shown at once; typing more finds the others. */
const MOST = 200;

/**
 * Makes the box; `chosen` is called with the value of an entry that was taken. `set(value)` shows a value.
 * @typedef {{ value: string, label: string, group: string, note?: string }} Entry
 * @param {{ id: string, entries: () => Entry[], chosen: (value: string) => void }} options
 */
export function chooser({ id, entries, chosen }) {
  const input = el("input", { type: "text", id, autocomplete: "off", spellcheck: false, placeholder: "type to search" });
  const list = el("ul", { id: `${id}-list`, class: "chooser-list", hidden: true });
  list.setAttribute("role", "listbox");
  list.setAttribute("aria-label", "Inputs that can vary");
  for (const [name, value] of [["role", "combobox"], ["aria-autocomplete", "list"], ["aria-expanded", "false"], ["aria-controls", list.id]]) input.setAttribute(name, value);
  let value = "";
  /** @type {Entry[]} */
  let shown = [];
  let active = -1;

  const nameOf = (one) => entries().find((entry) => entry.value === one)?.label ?? "";

  function open(text) {
    const words = text.toLowerCase().split(/\s+/).filter(Boolean);
    const found = entries().filter(({ label, group, value: pointer }) => words.every((word) => `${label} ${group} ${pointer}`.toLowerCase().includes(word)));
    shown = found.slice(0, MOST);
    active = shown.findIndex((entry) => entry.value === value);
    list.replaceChildren(...[...grouped(shown)].map(([group, members], place) => {
      const title = el("span", { class: "chooser-group", id: `${list.id}-${place}` }, group);
      const part = el("li", {}, title, el("ul", {}, ...members.map((entry) => option(entry, shown.indexOf(entry)))));
      part.setAttribute("role", "group");
      part.setAttribute("aria-labelledby", title.id);
      part.lastElementChild?.setAttribute("role", "presentation");
      return part;
    }));
    if (!shown.length) {
      const none = el("li", { class: "chooser-none" }, "No number of the document is called so");
      none.setAttribute("role", "presentation");
      list.replaceChildren(none);
    }
    show(list);
    input.setAttribute("aria-expanded", "true");
    mark();
  }

  function option(entry, place) {
    const node = el("li", { id: `${list.id}-option-${place}`, class: "chooser-option" }, el("span", {}, entry.label), el("span", { class: "chooser-note" }, entry.note ?? ""));
    node.setAttribute("role", "option");
    node.setAttribute("aria-selected", String(entry.value === value));
    // Before the box loses the focus.
    node.addEventListener("pointerdown", (event) => {
      event.preventDefault();
      take(entry);
    });
    return node;
  }

  function mark() {
    for (const node of list.querySelectorAll(".active")) node.classList.remove("active");
    const node = active < 0 ? null : list.querySelector(`#${CSS.escape(`${list.id}-option-${active}`)}`);
    node?.classList.add("active");
    node?.scrollIntoView({ block: "nearest" });
    if (node) input.setAttribute("aria-activedescendant", node.id);
    else input.removeAttribute("aria-activedescendant");
  }

  function close() {
    show(list, false);
    input.setAttribute("aria-expanded", "false");
    input.removeAttribute("aria-activedescendant");
  }

  function take(entry) {
    close();
    value = entry.value;
    input.value = entry.label;
    chosen(value);
  }

  input.addEventListener("focus", () => input.select());
  input.addEventListener("click", () => list.hidden && open(""));
  input.addEventListener("input", (event) => {
    event.stopPropagation();
    open(input.value);
    if (input.value && shown.length) active = 0;
    mark();
  });
  input.addEventListener("keydown", (event) => {
    if (event.key === "ArrowDown" || event.key === "ArrowUp") {
      event.preventDefault();
      if (list.hidden) open(input.value === nameOf(value) ? "" : input.value);
      else active = Math.min(shown.length - 1, Math.max(0, active + (event.key === "ArrowDown" ? 1 : -1)));
      mark();
    } else if (event.key === "Enter" && !list.hidden) {
      event.preventDefault();
      if (shown[active]) take(shown[active]);
    } else if (event.key === "Escape" && !list.hidden) {
      event.preventDefault();
      close();
    }
  });
  // Text that was typed but not selected is not a choice.
  input.addEventListener("blur", () => {
    close();
    if (input.value.trim() === "" && value !== "") {
      value = "";
      chosen("");
    }
    input.value = nameOf(value);
  });

  return {
    node: el("span", { class: "chooser" }, input, list),
    input,
    /** @param {string} next */
    set(next) {
      if (next === value && document.activeElement === input) return;
      value = next;
      input.value = nameOf(next);
    },
  };
}

/** @param {Entry[]} entries @returns {Map<string, Entry[]>} */
function grouped(entries) {
  const groups = new Map();
  for (const entry of entries) groups.set(entry.group, [...(groups.get(entry.group) ?? []), entry]);
  return groups;
}
