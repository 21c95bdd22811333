// Initial document of the form: an empty pair, an example, the document submitted last, a file, a gear model of another
// program, a draft of this browser, a job.

import * as api from "../common/api.js";
import { byId, el } from "../common/dom.js";
import { instant } from "../common/format.js";
import { emptyDocument } from "./document.js";
import { draft, dropDraft, dropOther, otherDrafts, rememberedStart, rememberStart, submitted, submittedFromHere } from "./draft.js";
import { asKind } from "./evaluations.js";
import { documentOf, initDrop, isModel } from "./files.js";
import { refusalOf, summaryOf, torqueQuestion } from "./imported.js";

/** @typedef {import("./draft.js").Start} Start */
/** @typedef {import("./draft.js").Kept} Kept */
/** @typedef {Omit<Kept, "at"> & { start: Start }} Contents what stands in the form, with what it was started from */

const EMPTY = "empty";
const SUBMITTED = "submitted";
const DRAFT = "draft:";
const EMPTY_CHOICE = "Start with an empty pair";
/** The example that the page comes with. */
const EXAMPLE_TITLE = "the example pair";

/**
 * Sets up the choice and the files. `fill(contents, isChosen)` fills the form, `read()` gives what stands in it. The
 * function returned fills the form at first.
 * @param {{ fill: (contents: Contents, isChosen?: boolean) => void, read: () => Contents }} form
 */
export function initStart({ fill, read }) {
  const choice = byId("start-from");
  const note = byId("start-note");
  /** @type {Awaited<ReturnType<typeof api.presets>> | null} */
  let presets = null;

  /** @param {string} text @param {Record<string, () => void>} [actions] by the texts of their buttons */
  const say = (text, actions = {}) => {
    note.replaceChildren(text);
    for (const [label, act] of Object.entries(actions)) {
      const button = el("button", { type: "button", class: label === EMPTY_CHOICE ? "primary" : "" }, label);
      button.addEventListener("click", () => {
        note.textContent = "";
        act();
        choice.value = "";
        choice.focus();
      });
      note.append(" ", button);
    }
  };

  /** @param {Contents} contents @param {string} text */
  const replace = (contents, text) => {
    const before = read();
    fill(contents, true);
    say(text, { Undo: () => fill(before, true) });
  };

  /** @param {Start} start @returns {Contents} */
  const startOf = (start) => ({ document: start.document, start });
  const empty = () => startOf({ kind: EMPTY, title: "an empty pair", document: emptyDocument() });
  /** @param {Kept} kept @returns {Contents} */
  const keptOf = (kept) => ({ ...kept, start: kept.start ?? { kind: DRAFT, title: "your draft", document: kept.document } });
  const submittedStart = () => {
    const kept = submitted();
    return kept && { kept, contents: startOf({ kind: SUBMITTED, title: "what was submitted", document: kept.document }) };
  };

  async function startFrom() {
    const { value } = choice;
    if (value === "") return;
    const label = choice.selectedOptions[0].label;
    try {
      if (value === EMPTY) {
        rememberStart("empty");
        return replace(empty(), "An empty pair. New jobs start with it from now on.");
      }
      if (value === SUBMITTED) {
        const last = submittedStart();
        if (last) replace(last.contents, `As submitted ${instant(last.kept.at)}.`);
        return;
      }
      if (value.startsWith(DRAFT)) return openDraft(value.slice(DRAFT.length));
      presets ??= await api.presets();
      const preset = presets.find(({ id }) => id === value);
      if (!preset || choice.value !== value) return;
      rememberStart("example");
      replace(startOf({ kind: "example", title: `the example “${preset.title}”`, document: preset.document }), preset.about);
    } catch (error) {
      say(`${label} could not be loaded: ${messageOf(error)}`);
    }
  }

  /** @param {string} key */
  function openDraft(key) {
    const kept = otherDrafts().find((one) => one.key === key);
    if (!kept) return listDrafts();
    replace(keptOf(kept), `The draft of ${instant(kept.at)}.`);
    dropOther(key);
    listDrafts();
  }

  /** Drafts of other tabs among the choices. */
  function listDrafts() {
    const others = otherDrafts();
    byId("start-drafts").replaceChildren(...others.map(({ key, at, document }) =>
      el("option", { value: `${DRAFT}${key}` }, [document.name, instant(at)].filter(Boolean).join(", "))));
    byId("start-drafts").hidden = others.length === 0;
    return others;
  }

  /** @param {File} file @param {ImportChoices} [choices] */
  async function openModel(file, choices = {}) {
    say(`Reading ${file.name} …`);
    try {
      const { document, ...report } = await api.importModel(file, choices);
      choice.value = "";
      /** @type {Start} */
      const start = { kind: "import", title: `the model ${file.name}`, document, report };
      const before = read();
      fill(startOf(start), true);
      /** @type {Record<string, () => void>} */
      const others = { Undo: () => fill(before, true) };
      for (const point of report.operating_points.filter(({ chosen }) => !chosen)) {
        others[`Load case ${point.number}`] = () => void openModel(file, { ...choices, point: point.number });
      }
      say(summaryOf(file.name, report), others);
    } catch (error) {
      const { text, pairs, needsTorque } = refusalOf(file.name, error);
      /** @type {Record<string, () => void>} */
      const actions = {};
      for (const { label, pair, mirror } of pairs) {
        actions[label] = () => void openModel(file, { ...choices, pair, ...(mirror ? { mirror } : {}) });
      }
      say(text, actions);
      if (needsTorque) note.append(" ", torqueQuestion((torque) => void openModel(file, { ...choices, torque_nm: torque })));
    }
  }

  /** @param {File} file */
  async function open(file) {
    if (await isModel(file)) return openModel(file);
    try {
      const document = await documentOf(file);
      choice.value = "";
      replace(startOf({ kind: "file", title: `the file ${file.name}`, document }), `From the file ${file.name}.`);
    } catch (error) {
      say(`${file.name} ${messageOf(error)}`);
    }
  }

  choice.addEventListener("change", startFrom);
  const upload = byId("upload");
  upload.addEventListener("change", () => {
    const [file] = upload.files ?? [];
    if (file) open(file);
    upload.value = "";
  });
  initDrop(open);
  for (const option of choice.options) if (option.value === SUBMITTED) option.disabled = !submitted();

  /** What the page came with. */
  const example = startOf({ kind: "example", title: EXAMPLE_TITLE, document: read().document });

  /** Fills the form as new jobs start in this browser. */
  function startAnew() {
    const others = listDrafts();
    /** @type {Record<string, () => void>} */
    const drafts = others.length ? { [`Open the draft of ${instant(others[0].at)}`]: () => openDraft(others[0].key) } : {};
    const remembered = rememberedStart();
    if (remembered === "empty") {
      fill(empty());
      say("An empty pair.", drafts);
      return;
    }
    fill(example);
    if (remembered) return say("The example pair. A job document or a gear model (REXS, KISSsoft) can be dropped anywhere on the page.", drafts);
    say("The form shows the example pair.", {
      [EMPTY_CHOICE]: () => {
        rememberStart("empty");
        fill(empty());
        say("An empty pair. New jobs start with it from now on.");
      },
      "Keep the example": () => rememberStart("example"),
      ...drafts,
    });
  }

  /**
   * The first contents: what was submitted from this place in the history, the job named in the address, the draft of
   * this tab, else what was chosen last: an empty pair, or the example that the page came with.
   */
  async function start() {
    const address = new URLSearchParams(window.location.search);
    const from = address.get("from");
    const kept = draft();
    const back = submittedFromHere();
    if (back && !(kept && kept.at > back.at)) {
      fill(keptOf(back));
      listDrafts();
      say(`As submitted ${instant(back.at)}. `);
      note.append(el("a", { href: `/jobs/${encodeURIComponent(back.job)}` }, "Its job"));
      return;
    }
    if (from && kept?.start?.id !== from) {
      try {
        const given = asKind(await api.input(from), address.get("as"));
        const start = { kind: "job", id: from, title: given.name ? `the job “${given.name}”` : "that job", document: given };
        fill(startOf(start));
        listDrafts();
        return say(`From the job ${given.name ? `“${given.name}”` : from}.`, kept ? { "My draft instead": () => fill(keptOf(kept)) } : {});
      } catch (error) {
        fill(example);
        return say(`The job ${from} could not be read: ${messageOf(error)}. The form shows the example pair.`);
      }
    }
    if (kept) {
      fill(keptOf(kept));
      listDrafts();
      const discard = () => {
        dropDraft();
        start();
      };
      return say(`Your draft of ${instant(kept.at)}, kept in this browser.`, { Discard: discard });
    }
    startAnew();
  }
  return start;
}

/** @param {unknown} error */
const messageOf = (error) => (error instanceof Error ? error.message : String(error));
