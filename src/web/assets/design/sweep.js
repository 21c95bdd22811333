// The form's section on sweeps: the choice of inputs by their names, a range or a list of values, a second axis, and
// the cost of the sweep. The fields of the document stay in the form; this fills them.

import { byAnyId, byId, el, show } from "../common/dom.js";
import { number, pointerLabel } from "../common/format.js";
import { chooser } from "./chooser.js";
import { costOf } from "./sweep_cost.js";

const RANGE = ["from", "to", "points", "spacing"];

/**
 * Sets the section up. `readDocument()` gives the present job document of the form; `changed()` tells the form that its
 * fields were set by a script.
 * @param {HTMLFormElement} form
 * @param {{ readDocument: () => JobInput, changed: () => void }} options
 *
 * @typedef {{
 *   form: HTMLFormElement,
 *   inputOf: (pointer: string) => any,
 *   fieldOf: (pointer: string) => any,
 *   changed: () => void,
 * }} Fields the fields of the form by their pointers
 */
export function initSweep(form, { readDocument, changed }) {
  const group = byAnyId("group-sweep");
  /** @param {string} pointer @returns {any} */
  const fieldOf = (pointer) => form.querySelector(`[data-pointer='${pointer}']`);
  /** @param {string} pointer @returns {any} */
  const inputOf = (pointer) => fieldOf(pointer)?.querySelector("input, select, textarea");
  if (!group || !inputOf("/axes/0/pointer")) return;
  const axes = [0, 1].map((place) => axisOf(place, { form, inputOf, fieldOf, changed }));
  const second = secondAxis(axes[1], changed);
  const told = [explanation("/continuation", fieldOf, CONTINUATION), recording("/record", fieldOf, changed)];
  const plan = el("p", { id: "sweep-plan", class: "sweep-plan" });
  plan.setAttribute("role", "status");
  group.append(plan);

  const update = () => {
    const document = readDocument();
    axes.forEach((axis) => axis.update(document));
    second.update();
    told.forEach((one) => one());
    plan.textContent = group.hidden ? "" : costOf(document);
  };
  // The text of the document follows every change of the form, those by scripts too.
  new MutationObserver(update).observe(byId("document-text"), { childList: true, characterData: true, subtree: true });
  update();
}

/** @type {Record<string, string>} */
const CONTINUATION = {
  none: "Each point starts from rest and is solved for itself, several at a time: the quickest. Where two motions exist only one is found.",
  up: "Each point goes on from its neighbour below, as when the input is raised slowly: shows up to where a motion lasts, and where it jumps.",
  down: "Each point goes on from its neighbour above, as when the input is lowered slowly.",
  both: "Up, then down: twice the points. Shows jumps, and the ranges in which two motions exist and which of them runs depends on the past.",
};

/** Optional contents of the rows. */
const RECORDED = [
  ["poincare", "Positions at the starts of mesh periods: a bifurcation diagram, which tells period 1, period n and chaos apart"],
  ["spectrum", "Spectrum of the acceleration: a map of the mesh orders over the first axis"],
];

/**
 * A sentence below a field about its present value.
 * @param {string} pointer
 * @param {Fields["fieldOf"]} fieldOf
 * @param {Record<string, string>} texts
 */
function explanation(pointer, fieldOf, texts) {
  const box = fieldOf(pointer);
  if (!box) return () => {};
  const input = box.querySelector("input, select, textarea");
  const text = el("p", { class: "help sweep-told" });
  (box.querySelector(".said") ?? box.lastElementChild).before(text);
  box.classList.add("sweep-wide");
  return () => { text.textContent = texts[input.value] ?? texts[""] ?? ""; };
}

/**
 * A check box for each optional content of the rows, in place of the text field.
 * @param {string} pointer
 * @param {Fields["fieldOf"]} fieldOf
 * @param {() => void} changed
 */
function recording(pointer, fieldOf, changed) {
  const box = fieldOf(pointer);
  if (!box) return () => {};
  const raw = box.querySelector("input, textarea");
  const words = () => raw.value.split(/[\s,;]+/).filter(Boolean);
  const ticks = RECORDED.map(([word, text]) => {
    const input = el("input", { type: "checkbox", id: `record-${word}` });
    input.addEventListener("input", (event) => event.stopPropagation());
    input.addEventListener("change", () => {
      raw.value = [...words().filter((one) => one !== word), ...(input.checked ? [word] : [])].join(", ");
      changed();
    });
    return { word, input, node: el("label", { class: "tick" }, input, text) };
  });
  const ticksBox = el("div", { class: "sweep-told" }, ...ticks.map(({ node }) => node), el("p", { class: "help" }, "Rows become larger; for sweeps of up to 5000 points."));
  ticksBox.setAttribute("role", "group");
  ticksBox.setAttribute("aria-label", "Recorded for every point");
  (box.querySelector(".said") ?? box.lastElementChild).before(ticksBox);
  box.classList.add("sweep-wide");
  return () => {
    const known = words();
    for (const { word, input } of ticks) input.checked = known.includes(word);
    // An unknown word stays visible, so that the error of the service has a field.
    raw.closest(".input").classList.toggle("off", known.every((word) => ticks.some((tick) => tick.word === word)));
  };
}

/** Numbers of the form that can vary: their names, groups, units and present values. @param {HTMLFormElement} form */
function sweepable(form) {
  const boxes = /** @type {HTMLElement[]} */ ([...form.querySelectorAll("[data-control='number'], [data-control='integer']")]);
  return boxes
    .filter(({ dataset }) => !/^\/(axes|analysis)\//.test(dataset.pointer ?? ""))
    .map((box) => {
      const { pointer = "" } = box.dataset;
      const { label, unit } = pointerLabel(pointer);
      const value = box.querySelector("input")?.value.trim() ?? "";
      const known = unit || box.dataset.unit || "";
      return {
        value: pointer, label: known ? `${label}, ${known}` : label, unit: known, now: value, hidden: box.hidden,
        group: box.closest(".group")?.querySelector("h2")?.textContent ?? "", note: value ? `now ${value}` : "",
      };
    });
}

/**
 * One axis: a box for the input's name, and a switch between a range and a list.
 * @param {number} place
 * @param {Fields} fields
 */
function axisOf(place, { form, inputOf, fieldOf, changed }) {
  /** @param {string} name */
  const at = (name) => `/axes/${place}/${name}`;
  const raw = inputOf(at("pointer"));
  const box = fieldOf(at("pointer"));
  const known = () => sweepable(form);
  const pick = chooser({
    id: `axis-${place}-input`, entries: () => known().filter(({ hidden }) => !hidden),
    chosen: (pointer) => { raw.value = pointer; changed(); },
  });
  const now = el("p", { class: "help axis-now", id: `axis-${place}-now` });
  pick.input.setAttribute("aria-describedby", now.id);
  const choice = el("div", { class: "field axis-input" }, el("label", { htmlFor: `axis-${place}-input` }, "Input that varies"), pick.node, now);
  box.before(choice);
  box.classList.add("axis-pointer");
  const label = box.querySelector("label");
  label.firstChild.textContent = "As a pointer into the document";

  const modes = [["range", "First and last value"], ["list", "List of values"]].map(([value, text]) => {
    const input = el("input", { type: "radio", name: `axis-${place}-mode`, value });
    input.addEventListener("input", (event) => event.stopPropagation());
    input.addEventListener("change", () => turn(value));
    return { input, label: el("label", {}, input, text) };
  });
  const segments = el("div", { class: "segments" }, ...modes.map((mode) => mode.label));
  segments.setAttribute("role", "radiogroup");
  segments.setAttribute("aria-label", "How the values are given");
  const mode = el("div", { class: "field axis-mode" }, segments);
  fieldOf(at("from")).before(mode);

  /** Values of the other mode, restored when the mode is switched back. @type {Record<string, string[] | null>} */
  const aside = { range: null, list: null };
  /** @param {string} to */
  function turn(to) {
    /** @type {Record<string, string[]>} */
    const of = { range: RANGE, list: ["values"] };
    const from = to === "list" ? "range" : "list";
    aside[from] = of[from].map((name) => inputOf(at(name)).value);
    of[from].forEach((name) => { const input = inputOf(at(name)); input.value = input.tagName === "SELECT" ? "linear" : name === "points" ? (fieldOf(at(name)).dataset.default ?? "") : ""; });
    aside[to]?.forEach((value, index) => { inputOf(at(of[to][index])).value = value; });
    wanted = to;
    changed();
  }

  /** @type {string | null} */
  let wanted = null;
  /** @param {string} name */
  const isFilled = (name) => inputOf(at(name)).value.trim() !== "";
  const modeNow = () => {
    if (isFilled("values")) return "list";
    return isFilled("from") || isFilled("to") ? "range" : wanted ?? "range";
  };

  return {
    isUsed: () => isFilled("pointer") || isFilled("from") || isFilled("to") || isFilled("values"),
    clear() {
      for (const name of ["pointer", "from", "to", "values"]) inputOf(at(name)).value = "";
      changed();
    },
    /** @type {HTMLElement} */
    block: box.closest(".block, fieldset"),
    focus: () => pick.input.focus(),
    /** @param {JobInput} document */
    update(document) {
      const mine = modeNow();
      for (const { input } of modes) input.checked = input.value === mine;
      // Hidden by a class only: their values count, and errors show them again.
      for (const name of RANGE) fieldOf(at(name)).classList.toggle("off", mine === "list" && !isFilled("from") && !isFilled("to"));
      fieldOf(at("values")).classList.toggle("off", mine === "range");
      choice.hidden = box.hidden;
      mode.hidden = box.hidden;
      const entry = known().find(({ value }) => value === raw.value.trim());
      pick.set(raw.value.trim());
      for (const name of ["from", "to", "values"]) unit(fieldOf(at(name)), entry?.unit ?? "");
      const count = document.axes?.[place] ? null : "";
      now.textContent = entry ? `The document has ${entry.now ? `${shown(entry.now)}${entry.unit ? ` ${entry.unit}` : ""}` : "its default"} for it; the sweep puts its own values in.` : count ?? (raw.value ? "Not a number of this form; the service says whether it is one of the document." : "");
    },
  };
}

/** @param {string} text */
const shown = (text) => (Number.isFinite(Number(text)) ? number(Number(text), 8) : text);

/** The unit of the input that varies, beside a field of the axis. @param {HTMLElement} box @param {string} text */
function unit(box, text) {
  const place = box.querySelector(".input") ?? box;
  let node = place.querySelector(".axis-unit");
  if (!node) {
    node = el("span", { class: "unit axis-unit" });
    place.querySelector("input, textarea")?.after(node);
  }
  for (const other of place.querySelectorAll(".unit:not(.axis-unit)")) /** @type {HTMLElement} */ (other).hidden = true;
  node.textContent = text;
}

/** The second axis, hidden until it is added. @param {ReturnType<typeof axisOf>} axis @param {() => void} changed */
function secondAxis(axis, changed) {
  const { block } = axis;
  let wanted = false;
  const add = el("button", { type: "button", id: "axis-add" }, "Add a second axis");
  const remove = el("button", { type: "button", id: "axis-remove", class: "quiet" }, "Remove the second axis");
  const adding = el("p", { class: "actions axis-add" }, add);
  block.before(adding);
  block.append(el("p", { class: "actions" }, remove));
  add.addEventListener("click", () => {
    wanted = true;
    changed();
    update();
    axis.focus();
  });
  remove.addEventListener("click", () => {
    wanted = false;
    axis.clear();
    add.focus();
  });
  function update() {
    const there = wanted || axis.isUsed();
    block.classList.toggle("off", !there);
    show(adding, !there && !block.hidden);
  }
  return { update };
}
