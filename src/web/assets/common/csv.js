// Tables as text files.

/** Rows of numbers and words as RFC 4180 writes them; each number reads back exactly. */
export const csvOf = (rows) => rows.map((row) => `${row.map(field).join(",")}\r\n`).join("");

function field(value) {
  const text = value === null || value === undefined ? "" : String(value);
  // A text that a spreadsheet would take for a formula is told to be a text.
  const safe = typeof value === "string" && /^[=+\-@\t\r]/.test(text) ? `'${text}` : text;
  return /[",\r\n]/.test(safe) ? `"${safe.replaceAll('"', '""')}"` : safe;
}
