// Initial document of the form: an example, the document submitted last, a file, a draft of this browser, a job.

import * as api from "../common/api.js";
import { byId, el } from "../common/dom.js";
import { instant } from "../common/format.js";
import { textOf } from "../common/text.js";
import { draft, dropDraft, submitted } from "./draft.js";

const SUBMITTED = "submitted";

/**
 * Sets up the choice and the files. `fill(document)` fills the form, `read()` gives its document, `failed(error)`
 * shows an error. The function returned fills the form at first.
 * @param {{ fill: (document: JobInput) => void, read: () => JobInput, failed: (error: unknown) => void }} form
 */
export function initStart({ fill, read, failed }) {
  const choice = byId("start-from");
  const note = byId("start-note");
  /** @type {Awaited<ReturnType<typeof api.presets>> | null} */
  let presets = null;

  /** @param {string} text @param {(() => void) | null} [undo] @param {string} [label] */
  const say = (text, undo = null, label = "Undo") => {
    note.replaceChildren(text);
    if (!undo) return;
    const button = el("button", { type: "button", class: "quiet" }, label);
    button.addEventListener("click", () => {
      undo();
      note.textContent = "";
      choice.value = "";
      choice.focus();
    });
    note.append(" ", button);
  };

  /** @param {JobInput} document @param {string} text */
  const replace = (document, text) => {
    const before = read();
    fill(document);
    say(text, () => fill(before));
  };

  async function startFrom() {
    const { value } = choice;
    if (value === "") return;
    const label = choice.selectedOptions[0].label;
    try {
      if (value === SUBMITTED) {
        const kept = submitted();
        if (kept) replace(kept.document, `As submitted ${instant(kept.at)}.`);
        return;
      }
      presets ??= await api.presets();
      const preset = presets.find(({ id }) => id === value);
      if (preset && choice.value === value) replace(preset.document, preset.about);
    } catch (error) {
      say(`${label} could not be loaded: ${messageOf(error)}`);
    }
  }

  /** @param {File} file */
  async function open(file) {
    try {
      const document = JSON.parse(textOf(await file.arrayBuffer()));
      if (document === null || typeof document !== "object" || Array.isArray(document)) throw new Error("it is not a JSON object");
      choice.value = "";
      replace(document, `From the file ${file.name}.`);
    } catch (error) {
      say(`${file.name} is not a job document: ${messageOf(error)}`);
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

  /** The first contents: the job named in the address, else the draft, else the example that the page came with. */
  return async function start() {
    const from = new URLSearchParams(window.location.search).get("from");
    const initial = read();
    const kept = draft();
    if (from) {
      try {
        fill(await api.input(from));
        say(`From the job ${from}.`, kept && (() => fill(kept.document)), "My draft instead");
        return;
      } catch (error) {
        failed(error);
      }
    }
    if (!from && kept && JSON.stringify(kept.document) !== JSON.stringify(initial)) {
      fill(kept.document);
      const discard = () => {
        fill(initial);
        dropDraft();
      };
      say(`Your draft of ${instant(kept.at)}, kept in this browser.`, discard, "Discard");
      return;
    }
    fill(null);
  };
}

/** @param {unknown} error */
const messageOf = (error) => (error instanceof Error ? error.message : String(error));

/** Opens a file that is dropped anywhere on the page. @param {(file: File) => void} open */
function initDrop(open) {
  const target = byId("drop-target");
  /** @param {DragEvent} event */
  const hasFile = (event) => [...(event.dataTransfer?.types ?? [])].includes("Files");
  let depth = 0;
  /** @param {boolean} visible */
  const shown = (visible) => {
    if (!visible) depth = 0;
    target.hidden = !visible;
  };
  window.addEventListener("dragenter", (event) => {
    if (!hasFile(event)) return;
    event.preventDefault();
    depth += 1;
    shown(true);
  });
  window.addEventListener("dragleave", (event) => {
    if (!hasFile(event)) return;
    depth -= 1;
    if (depth <= 0) shown(false);
  });
  window.addEventListener("dragover", (event) => {
    if (hasFile(event)) event.preventDefault();
  });
  window.addEventListener("drop", (event) => {
    if (!hasFile(event)) return;
    event.preventDefault();
    shown(false);
    const [file] = event.dataTransfer?.files ?? [];
    if (file) open(file);
  });
}
