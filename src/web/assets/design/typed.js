// Parser of typed numbers: a decimal point or one decimal comma, spaces between thousands, a minus of any kind,
// powers of ten, and the field's unit behind. Ambiguous numbers are refused; the job document itself has
// decimal points only.

const POINT = "write decimals with a decimal point";

/**
 * Other ways of writing a unit; of both sides the letters count, with µ as u, powers as digits, and no dots or
 * spaces.
 */
const SAME = {
  um: ["micron", "microns", "micrometer", "micrometre"],
  "°": ["º", "deg", "degree", "degrees", "Grad"],
  "r/min": ["rpm", "RPM", "1/min", "/min", "min-1", "U/min", "rev/min"],
  mm: ["millimeter", "millimetre"],
  "%": ["percent"],
};
const MINUS = /[\u2212\u2010\u2011\u2012\u2013\ufe63\uff0d]/g;
/** Spaces that do not separate: no-break, thin, figure and narrow ones. */
const THIN = /[\u00a0\u2007\u2009\u200a\u202f]/g;
const SUPERSCRIPTS = "⁰¹²³⁴⁵⁶⁷⁸⁹";

/** Digits that spaces may divide into thousands. */
const GROUPED = /^[+-]?\d{1,3}(?: \d{3})+(?!\d)/;

const plainUnit = (text) =>
  text.replace(/[µμ]/g, "u").replace(/⁻/g, "-").replace(/[²³¹]/g, (sign) => String(SUPERSCRIPTS.indexOf(sign))).replace(/[·⋅*^\s\u00a0\u2009\u202f]/g, "");

function isUnit(typed, unit) {
  const [given, wanted] = [plainUnit(typed), plainUnit(unit)];
  return given === wanted || (SAME[wanted]?.includes(given) ?? false);
}

/** Full-width signs as plain ones, every minus as "-", powers such as 10⁻⁶ as 10^-6. */
function plain(text) {
  return text
    .replace(/[\uff0b-\uff1b]/g, (sign) => String.fromCharCode(sign.charCodeAt(0) - 0xfee0))
    .replace(MINUS, "-")
    .replace(/10([⁺⁻]?)([⁰¹²³⁴⁵⁶⁷⁸⁹]+)/g, (_, sign, digits) => `10^${sign === "⁻" ? "-" : ""}${[...digits].map((digit) => SUPERSCRIPTS.indexOf(digit)).join("")}`);
}

/**
 * Parses one number. Returns { value }; or { refused }, the reason why a text that looks like a number is refused; or
 * neither. `comma`: "clear" if a comma in it is a decimal one, "maybe" if it may separate thousands.
 */
function readNumber(text, unit = "") {
  const typed = plain(text).replace(THIN, " ").trim();
  const angle = unit === "°" ? degrees(typed) : null;
  if (angle) return angle;
  const found = typed.match(/^([+-]?\s*(?:[.,]?\d)[\d.,'’ ]*?)(?:\s*[·×*x]\s*10\s*(?:\^|\*\*)\s*([+-]?\d+)|[eE]([+-]?\d+))?\s*((?:[^\d\s.,'’+-]|\d*\/).*)?$/u);
  if (!found) return /^[+-]?\s*[.,]?\d[\d.,'’ ]*$/.test(typed) ? unclear(text) : {};
  const [, body, power, exponent, typedUnit] = found;
  if (typedUnit && !isUnit(typedUnit, unit)) {
    return { refused: unit ? `is given in “${typedUnit}”; this field is in ${unit}` : `is followed by “${typedUnit}”; this field takes a number without a unit` };
  }
  return decimalOf(body.trim(), power ?? exponent ?? "0", text);
}

function decimalOf(body, exponent, text) {
  const sign = body.startsWith("-") ? "-" : "";
  const digits = body.replace(/^[+-]\s*/, "");
  const parts = digits.split(/[.,]/);
  if (parts.length > 2) return unclear(text);
  const [whole, fraction = ""] = parts;
  const isGrouped = /[ '’]/.test(whole);
  if (isGrouped && !/^\d{1,3}(?:([ '’])\d{3})(?:\1\d{3})*$/.test(whole)) return unclear(text);
  if (/[ '’]/.test(fraction) || (digits.includes(",") && fraction === "")) return unclear(text);
  let comma = null;
  if (digits.includes(",")) comma = fraction.length === 3 && /^[1-9]\d{0,2}$/.test(whole) ? "maybe" : "clear";
  const value = Number(`${sign}${whole.replace(/[ '’]/g, "")}.${fraction}e${exponent}`);
  return Number.isFinite(value) ? { value, comma } : { refused: `is too large a number` };
}

/** Degrees with minutes and seconds of arc: 30°15', 30° 15′ 20″. */
function degrees(typed) {
  const found = typed.match(/^([+-]?)\s*(\d+)\s*[°º]\s*(?:(\d+(?:[.,]\d+)?)\s*['’′])?\s*(?:(\d+(?:[.,]\d+)?)\s*(?:["”″]|''))?$/);
  if (!found || (found[3] === undefined && found[4] === undefined)) return null;
  const [minutes, seconds] = [found[3] ?? "0", found[4] ?? "0"].map((part) => Number(part.replace(",", ".")));
  if (minutes >= 60 || seconds >= 60) return { refused: "has minutes or seconds of arc of 60 or more" };
  if (found[4] !== undefined && !Number.isInteger(minutes)) return { refused: "has a fraction of a minute beside seconds of arc" };
  const value = (Number(found[2]) * 3600 + minutes * 60 + seconds) / 3600;
  return { value: found[1] === "-" ? -value : value, comma: null };
}

function unclear(text) {
  return { refused: `“${clip(text)}” can be read in more than one way: ${POINT} and without a sign between thousands` };
}

/** A single field: a comma that may stand between thousands is refused. */
export function readField(text, unit) {
  const read = readNumber(text, unit);
  if (read.comma !== "maybe") return read;
  const [point, none] = [read.value, text.replace(/[^\d,-]/g, "").replace(",", "")];
  return { refused: `“${clip(text)}” can be ${point} or ${none}: ${POINT}` };
}

/**
 * Parses a list of numbers. Returns { values } (with unreadable items as text), or { refused }. Semicolons, tabs and
 * lines separate; without them commas with a space, or spaces. A comma without a space behind it is a decimal one
 * when something else separates.
 */
export function readList(text, unit = "") {
  const typed = plain(text).replace(THIN, "\u202f").trim().replace(/^\[(.*)\]$/s, "$1").trim();
  const refused = { refused: `“${clip(text)}” can be read in more than one way: ${POINT}, and separate the values with semicolons` };
  let items = typed.split(/\s*[;\t\r\n]+\s*/).filter(Boolean);
  const hasLines = items.length > 1 || /[;\t\r\n]/.test(typed);
  const hasSemicolon = typed.includes(";");
  const isSpaced = /,\s|\s,|,$/m.test(typed);
  const isInner = /[\d.],[\d.]/.test(typed);
  if (isSpaced) {
    // Commas separate: then they are not decimal signs too, and nothing else separates but lines.
    if (isInner || hasSemicolon) return refused;
    items = items.flatMap((item) => item.split(/\s*,\s*/)).filter(Boolean);
    // Spaces in an item separate as well, where they cannot stand between thousands; "200 300" can be both.
    if (items.some((item) => GROUPED.test(item) && !/ 0/.test(item))) return refused;
    items = items.flatMap((item) => (GROUPED.test(item) ? [item] : spaced(item)));
  } else if (isInner && typed.includes(".")) {
    if (hasLines) return refused;
    items = spaced(typed).flatMap((item) => item.split(","));
    if (!items.every((item) => item.includes("."))) return refused;
  } else if (!hasLines) {
    items = spaced(typed);
    if (isInner && items.length === 1) return refused;
    // "1 000": spaces between thousands look like those between values.
    if (items.some((item) => /^0\d\d$/.test(item))) return refused;
  }
  const read = items.map((item) => readNumber(item, unit));
  const why = read.find((one) => one.refused);
  if (why) return why;
  const commas = read.map(({ comma }) => comma).filter(Boolean);
  if (commas.length && (!commas.includes("clear") || items.some((item) => /\d\.\d/.test(item)))) return refused;
  return { values: read.map(({ value }, index) => value ?? items[index]) };
}

/** Items between spaces; a unit stays with its number. */
function spaced(text) {
  const items = [];
  for (const word of text.split(/ +/).filter(Boolean)) {
    if (items.length && !/^[+-]?[.,]?\d/.test(word)) items.push(`${items.pop()} ${word}`);
    else items.push(word);
  }
  return items;
}

const clip = (text) => (text.trim().length > 40 ? `${text.trim().slice(0, 39)}…` : text.trim());
