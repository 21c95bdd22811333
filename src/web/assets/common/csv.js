// Tables as text files, in the dialect that this browser remembers: with a decimal point (RFC 4180), or as
// spreadsheets read it whose language writes a decimal comma.

const KEY = "herringbone.csv-decimal";
const COMMA = "comma";
/** U+FEFF at the start marks the text as UTF-8 for spreadsheets. */
const MARK = "\ufeff";

let chosen = stored();

function stored() {
  // A browser may keep pages from storing anything.
  try {
    return localStorage.getItem(KEY) === COMMA ? COMMA : "point";
  } catch {
    return "point";
  }
}

/** The decimal sign of files: "point" or "comma", as the service's parameter `decimal` takes it. */
export const decimal = () => chosen;

/** Rows of numbers and words; each number reads back exactly. */
export function csvOf(rows, sign = chosen) {
  const text = rows.map((row) => `${row.map((value) => field(value, sign)).join(sign === COMMA ? ";" : ",")}\r\n`).join("");
  return sign === COMMA ? MARK + text : text;
}

function field(value, sign) {
  const text = value === null || value === undefined ? "" : String(value);
  if (typeof value === "number") return !Number.isFinite(value) && sign === COMMA ? "" : sign === COMMA ? text.replace(".", ",") : text;
  // The apostrophe keeps a spreadsheet from evaluating a text as a formula.
  const safe = typeof value === "string" && /^[=+\-@\t\r]/.test(text) ? `'${text}` : text;
  const special = sign === COMMA ? /[";\r\n]/ : /[",\r\n]/;
  return special.test(safe) ? `"${safe.replaceAll('"', '""')}"` : safe;
}

/** The choice in the footer, on pages that offer such files. */
const choice = /** @type {HTMLSelectElement | null} */ (document.getElementById("csv-decimal"));
if (choice) {
  choice.value = chosen;
  choice.hidden = false;
  choice.addEventListener("change", () => {
    chosen = choice.value;
    try {
      localStorage.setItem(KEY, chosen);
    } catch {
      // It holds for this page then.
    }
  });
  // Another window of this browser chose.
  window.addEventListener("storage", ({ key }) => {
    if (key !== KEY) return;
    chosen = stored();
    choice.value = chosen;
  });
}
