/** Bytes as text, and text as people write it in Python. */

export const hexDigits = (byte) => byte.toString(16).toUpperCase().padStart(2, "0");

/** `55 02 01`. */
export const hexOf = (bytes) => Array.from(bytes, hexDigits).join(" ");

/** Bytes of digits without anything between them. */
export function fromHex(digits) {
  const bytes = new Uint8Array(digits.length / 2);
  for (let at = 0; at < bytes.length; at++) bytes[at] = parseInt(digits.slice(2 * at, 2 * at + 2), 16);
  return bytes;
}

export const latin1 = (bytes) => Array.from(bytes, (byte) => String.fromCharCode(byte)).join("");

export const startsWith = (bytes, first) => first.every((byte, index) => bytes[index] === byte);

/** A text in double quotes, with escapes for what can't be printed. */
export const quoted = (text) =>
  JSON.stringify(text).replace(/[^ -~]/g, (c) => `\\u${c.charCodeAt(0).toString(16).padStart(4, "0")}`);

/** Bytes as Python shows them. */
export function pythonBytes(bytes) {
  const text = latin1(bytes);
  const mark = text.includes("'") && !text.includes('"') ? '"' : "'";
  const named = { "\\": "\\\\", "\n": "\\n", "\r": "\\r", "\t": "\\t", [mark]: `\\${mark}` };
  const shown = Array.from(text, (c) => {
    if (c in named) return named[c];
    return c >= " " && c <= "~" ? c : `\\x${c.charCodeAt(0).toString(16).padStart(2, "0")}`;
  });
  return `b${mark}${shown.join("")}${mark}`;
}
