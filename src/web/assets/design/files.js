// Files that are opened or dropped on the form: a job document, a gear model of another program, or neither.

import { byId } from "../common/dom.js";
import { number } from "../common/format.js";
import { textOf } from "../common/text.js";

/** Largest body that the service accepts, bytes. */
const MOST_BYTES = 1024 * 1024;

/** Beginnings of other files, a character for each byte. @type {[string, string][]} */
const OTHER_FILES = [
  ["\x89PNG", "a PNG image"],
  ["\xff\xd8\xff", "a JPEG image"],
  ["GIF8", "a GIF image"],
  ["%PDF", "a PDF document"],
  ["\xd0\xcf\x11\xe0", "a document of an office program"],
  ["\x1f\x8b", "a compressed file (gzip)"],
  ["SQLite format 3", "a database"],
];

/** @param {number} bytes */
const size = (bytes) => (bytes < 1e6 ? `${number(bytes / 1024, 3)} KiB` : `${number(bytes / 1024 / 1024, 3)} MiB`);

/** Names of gear models. */
const MODEL_NAMES = /\.(rexs|rexsj|rexsz|rexs\.(xml|json|zip)|z12)$/i;

/** Whether a file is a gear model of another program, which the service reads. @param {File} file */
export async function isModel(file) {
  if (MODEL_NAMES.test(file.name)) return true;
  const head = String.fromCharCode(...new Uint8Array(await file.slice(0, 4096).arrayBuffer()));
  if (head.startsWith("PK\u0003\u0004")) return /\.rexs|\.rexsj/i.test(head);
  return (/^[^{[]*<[!?a-z]/i.test(head) && /\brexs\b|<model\b/i.test(head)) || /^[^{]*\{\s*"model"\s*:\s*\{/.test(head);
}

/**
 * The job document in a file.
 * @param {File} file
 * @returns {Promise<JobInput>}
 * @throws {Error} with the reason why it is refused, as a sentence after the name of the file
 */
export async function documentOf(file) {
  const bytes = new Uint8Array(await file.slice(0, 4096).arrayBuffer());
  const head = String.fromCharCode(...bytes);
  const other = OTHER_FILES.find(([start]) => head.startsWith(start))?.[1];
  if (other) throw new Error(`is ${other}, not a job document (JSON).`);
  const isXml = /^[^{[]*<[!?a-z]/i.test(head);
  if (head.startsWith("PK\u0003\u0004")) throw new Error("is a ZIP archive or a spreadsheet, not a job document (JSON). Columns of a spreadsheet can be pasted into lists.");
  if (isXml) throw new Error("is an XML or HTML file, not a job document (JSON).");
  if (file.size > MOST_BYTES) throw new Error(`has ${size(file.size)}; a job document has ${size(MOST_BYTES)} at most.`);
  if (file.size === 0) throw new Error("is empty.");
  let document;
  try {
    document = JSON.parse(textOf(await file.arrayBuffer()));
  } catch (error) {
    throw new Error(`is not a job document: ${error instanceof Error ? error.message : error}`, { cause: error });
  }
  if (document === null || typeof document !== "object" || Array.isArray(document)) throw new Error("is not a job document: it is not a JSON object");
  if (document.numerics && document.geometry) throw new Error("is the result of a job. Open the job document that it was calculated from.");
  return document;
}

/** Opens a file that is dropped anywhere on the page. @param {(file: File) => void} open */
export function initDrop(open) {
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
