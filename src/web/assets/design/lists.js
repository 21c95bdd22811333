// Lists of objects in the form: as many blocks or rows of fields as one wants. The server renders the fields of one
// object as a template, with "*" in place of its number in pointers and identifiers, and a mark in texts.

import { el } from "../common/dom.js";

/** @typedef {{ texts: Map<string, string>, open: boolean }} Item texts of an object's fields by their pointers in it */

/** @param {ParentNode} root @returns {HTMLElement[]} */
const listsIn = (root) => [.../** @type {NodeListOf<HTMLElement>} */ (root.querySelectorAll("[data-list]"))];

/** The elements of a list itself, not of a list in it. @param {HTMLElement} list */
const partsOf = (list) => ({
  items: /** @type {HTMLElement} */ (list.querySelector("[data-items]")),
  template: /** @type {HTMLTemplateElement} */ ([...list.querySelectorAll("template")].find((one) => one.closest("[data-list]") === list)),
  count: /** @type {HTMLInputElement} */ (list.querySelector(`[data-pointer='${list.dataset.list}'] input`)),
});

/** @param {HTMLElement} list @returns {HTMLElement[]} */
const itemsOf = (list) => [.../** @type {NodeListOf<HTMLElement>} */ (partsOf(list).items.querySelectorAll(":scope > [data-item]"))];

/** Number of objects of the list with a field in it. @param {HTMLElement} box */
export function countAt(box) {
  const list = /** @type {HTMLElement | null} */ (box.closest("[data-list]"));
  return list ? itemsOf(list).length : 0;
}

/**
 * Makes as many objects as the document has, with empty fields.
 * @param {HTMLElement} form
 * @param {(pointer: string) => number} countOf number of objects of the list at a pointer
 */
export function fillLists(form, countOf) {
  const fill = (/** @type {HTMLElement} */ list) => {
    setCount(list, 0);
    setCount(list, countOf(list.dataset.list ?? ""));
    itemsOf(list).flatMap(listsIn).forEach(fill);
  };
  listsIn(form).filter((list) => !list.parentElement?.closest("[data-list]")).forEach(fill);
}

/** @param {HTMLElement} list @param {number} count */
function setCount(list, count) {
  const { items, template, count: input } = partsOf(list);
  const now = itemsOf(list);
  now.slice(count).forEach((item) => item.remove());
  for (let index = now.length; index < count; index += 1) items.append(made(template, index));
  input.value = String(count);
  if (list instanceof HTMLDetailsElement && count > 0) list.open = true;
}

/** An object of the template, with its number. @param {HTMLTemplateElement} template @param {number} index */
function made(template, index) {
  const content = /** @type {DocumentFragment} */ (template.content.cloneNode(true));
  numbered(content, index, template.dataset.mark ?? "#");
  return content;
}

/** @param {DocumentFragment} root @param {number} index @param {string} mark */
function numbered(root, index, mark) {
  const walker = document.createTreeWalker(root, NodeFilter.SHOW_ELEMENT | NodeFilter.SHOW_TEXT);
  while (walker.nextNode()) {
    const node = walker.currentNode;
    if (node instanceof Element) {
      for (const { name, value } of node.attributes) {
        const filled = value.replaceAll(/[^\s]+/g, (word) => word.replace("*", String(index))).replace(mark, String(index + 1));
        if (filled !== value) node.setAttribute(name, filled);
      }
      if (node instanceof HTMLTemplateElement) numbered(node.content, index, mark);
    } else if (node.textContent?.includes(mark)) {
      node.textContent = node.textContent.replace(mark, String(index + 1));
    }
  }
}

/**
 * What stands in an object, to be put into another.
 * @param {HTMLElement} item @param {string} prefix pointer of the object
 * @returns {Item}
 */
function taken(item, prefix) {
  const boxes = [.../** @type {NodeListOf<HTMLElement>} */ (item.querySelectorAll("[data-pointer]"))];
  const texts = boxes.map((box) => /** @type {[string, string]} */ ([(box.dataset.pointer ?? "").slice(prefix.length), box.querySelector("input")?.value ?? ""]));
  return { texts: new Map(texts), open: item.querySelector("details")?.open ?? false };
}

/** Replaces the objects of a list. @param {HTMLElement} list @param {(Item | null)[]} contents */
function replace(list, contents) {
  setCount(list, 0);
  setCount(list, contents.length);
  itemsOf(list).forEach((item, index) => {
    const content = contents[index];
    if (!content) return;
    const prefix = `${list.dataset.list}/${index}`;
    for (const inner of listsIn(item)) {
      setCount(inner, Number(content.texts.get((inner.dataset.list ?? "").slice(prefix.length)) ?? 0));
      if (inner instanceof HTMLDetailsElement) inner.open = content.open;
    }
    for (const box of /** @type {NodeListOf<HTMLElement>} */ (item.querySelectorAll("[data-pointer]"))) {
      const input = box.querySelector("input");
      const text = content.texts.get((box.dataset.pointer ?? "").slice(prefix.length));
      if (input && text !== undefined) input.value = text;
    }
  });
}

/** Largest number of objects that is made at once. */
const MOST = 100;

/**
 * Sets the buttons and numbers of all lists up; `changed` is called after one was used.
 * @param {HTMLFormElement} form
 * @param {() => void} changed
 */
export function initLists(form, changed) {
  const said = el("p", { class: "visually-hidden" });
  said.setAttribute("role", "status");
  form.append(said);

  /** @param {HTMLElement} list @returns {(Item | null)[]} */
  const contentsOf = (list) => itemsOf(list).map((item, index) => taken(item, `${list.dataset.list}/${index}`));
  /** @param {HTMLElement | undefined} place */
  const goTo = (place) => /** @type {HTMLElement | null | undefined} */ (place?.querySelector("input, button"))?.focus();

  form.addEventListener("click", (event) => {
    const button = /** @type {HTMLElement | null} */ (/** @type {Element} */ (event.target).closest("[data-act]"));
    const list = /** @type {HTMLElement | null | undefined} */ (button?.closest("[data-list]"));
    if (!button || !list) return;
    const contents = contentsOf(list);
    const act = button.dataset.act;
    if (act === "add") {
      setCount(list, contents.length + 1);
      goTo(itemsOf(list).at(-1));
    } else {
      const at = itemsOf(list).findIndex((item) => item.contains(button));
      replace(list, act === "insert" ? contents.toSpliced(at + 1, 0, null) : contents.toSpliced(at, 1));
      const items = itemsOf(list);
      goTo(act === "insert" ? items[at + 1] : items[Math.min(at, items.length - 1)]);
      if (!items.length) /** @type {HTMLElement | null} */ (list.querySelector("[data-act='add']"))?.focus();
    }
    said.textContent = `${itemsOf(list).length} in the list`;
    changed();
  });

  /** @param {Event} event */
  const count = (event) => {
    const input = /** @type {HTMLInputElement} */ (event.target);
    const box = input.closest("[data-control='list']");
    const list = /** @type {HTMLElement | null | undefined} */ (box?.closest("[data-list]"));
    if (!box || !list) return;
    const wanted = input.value.trim() === "" ? NaN : Math.trunc(Number(input.value));
    setCount(list, Number.isFinite(wanted) ? Math.min(Math.max(wanted, 0), MOST) : itemsOf(list).length);
    changed();
  };
  form.addEventListener("change", count);
  form.addEventListener("keydown", (event) => { if (event.key === "Enter") count(event); });
}
