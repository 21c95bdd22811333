// Text from files: UTF-8 is read, with or without a byte order mark; other encodings are named.

/** Byte order marks of other encodings; UTF-32's begins as UTF-16's. @type {[number[], string][]} */
const OTHER_MARKS = [
  [[0xff, 0xfe, 0, 0], "UTF-32 (little-endian)"],
  [[0, 0, 0xfe, 0xff], "UTF-32 (big-endian)"],
  [[0xff, 0xfe], "UTF-16 (little-endian)"],
  [[0xfe, 0xff], "UTF-16 (big-endian)"],
];
/**
 * Positions of the zero bytes of ASCII characters among the first four bytes, with the encoding (RFC 4627, section 3).
 * @type {[RegExp, string][]}
 */
const ZEROS = [
  [/^000x/, "UTF-32 (big-endian)"],
  [/^x000/, "UTF-32 (little-endian)"],
  [/^0x/, "UTF-16 (big-endian)"],
  [/^x0/, "UTF-16 (little-endian)"],
];

/**
 * The text of a file's bytes, without a byte order mark; throws an error that names the encoding when it is not
 * UTF-8.
 */
export function textOf(buffer) {
  const bytes = new Uint8Array(buffer);
  const pattern = [...bytes.subarray(0, 4)].map((byte) => (byte === 0 ? "0" : "x")).join("");
  const other = OTHER_MARKS.find(([mark]) => mark.every((byte, index) => bytes[index] === byte)) ?? ZEROS.find(([zeros]) => zeros.test(pattern));
  if (other) throw new Error(`it is encoded in ${other[1]}; needed: UTF-8`);
  try {
    return new TextDecoder("utf-8", { fatal: true }).decode(bytes);
  } catch {
    throw new Error("it is not encoded in UTF-8 (perhaps in Windows-1252 or ISO 8859-1); needed: UTF-8");
  }
}
