/** Bytes as people have them: hex in any dress, arrays of C, candump, logs, exports of analysers. */
import { fromHex } from "./octets.js";

/** Text that stands for no bytes; `line` and `column` count from 1. */
export class InputError extends Error {
  constructor(line, column, problem) {
    super(`line ${line}, column ${column}: ${problem}`);
  }
}

/** A piece of input: bytes, the time in nanoseconds or null, and a name in front of it. */
const piece = (bytes, time = null, name = "") => ({ bytes, time, name });

/** What a text holds: its form in words, its pieces, and notes on lines that were left out. */
export function piecesOf(text, names) {
  for (const read of [quotedBytes, cArray, dump, candump, saleae, sigrok, timedLines]) {
    const found = read(text, names);
    if (found) return directed(found);
  }
  return { form: "hex", pieces: [piece(parseHex(text))], notes: [] };
}

/** The directions of a log tell senders apart where there are both, else nothing. */
function directed(found) {
  const named = (name) => found.pieces.some((item) => item.name === name);
  if (named("TX") && named("RX")) found.notes.unshift("TX is what the side chosen sends, RX what the other sends");
  else for (const item of found.pieces) if (/^[RT]X$/.test(item.name)) item.name = "";
  return found;
}

// --- hex -----------------------------------------------------------------------------------------

const TOKEN = /([\s,;:]+)|(#[^\n]*)|(0[xX]|\\[xX]|)([0-9A-Fa-f]+)(?![xX])/y;

/** The bytes of hex digits: `1B 02`, `1b02`, `0x1B,0x02`, `\x1b\x02`, `1B:02`. */
export function parseHex(text) {
  const bytes = [];
  let at = 0;
  while (at < text.length) {
    TOKEN.lastIndex = at;
    const found = TOKEN.exec(text);
    if (!found) throw stranger(text, at);
    const [all, , , prefix, digits] = found;
    if (digits !== undefined) {
      const isSingle = digits.length === 1 && /0x/i.test(prefix);
      if (digits.length % 2 && !isSingle) throw odd(text, at, all);
      bytes.push(...fromHex(isSingle ? `0${digits}` : digits));
    }
    at += all.length;
  }
  return Uint8Array.from(bytes);
}

function placed(text, at, problem) {
  const before = text.slice(0, at);
  const line = before.split("\n").length;
  return new InputError(line, at - before.lastIndexOf("\n"), problem);
}

function stranger(text, at) {
  const place = at + (/[0-9A-Fa-f]/.test(text[at]) ? 1 : 0);
  return placed(text, place, `\`${text[place] ?? ""}\` is no hex digit and no separator`);
}

function odd(text, at, all) {
  const next = text[at + all.length];
  if (next !== undefined && !/[\s,;:#\\0-9A-Fa-f]/.test(next)) return stranger(text, at + all.length);
  return placed(text, at, `\`${all.slice(-20)}\` has an odd number of hex digits`);
}

const DUMP_LINE = /^([0-9A-Fa-f]{6,16})(:?)\s+([^|]*)(\|.*)?$/;

/** Lines of `xxd` and `hexdump -C`: an offset, bytes, and characters. The offsets have to fit. */
function dump(text) {
  const bytes = [];
  for (const line of text.split("\n").map((item) => item.trim())) {
    const [, at, colon, rest, bar] = DUMP_LINE.exec(line) ?? [];
    // The last line of `hexdump -C` is the size alone.
    if (at === undefined && line && parseInt(line, 16) !== bytes.length) return null;
    if (at === undefined) continue;
    const digits = (bar ? rest : rest.split(/\s{2,}/)[0]).replace(/\s/g, "");
    const isDump = (colon || bar) && parseInt(at, 16) === bytes.length && /^(?:[0-9A-Fa-f]{2})+$/.test(digits);
    if (!isDump) return null;
    for (const byte of fromHex(digits)) bytes.push(byte);
  }
  return bytes.length ? { form: "a dump", pieces: [piece(Uint8Array.from(bytes))], notes: [] } : null;
}

// --- arrays and texts of programs ----------------------------------------------------------------

function quotedBytes(text) {
  const found = /^\s*b?(["'])((?:\\.|(?!\1)[^\\])*)\1\s*;?\s*$/s.exec(text);
  if (!found) return null;
  const codes = { n: 10, r: 13, t: 9, 0: 0, "\\": 92, "'": 39, '"': 34, a: 7, b: 8, f: 12, v: 11 };
  const bytes = [];
  for (const [, escape, character] of found[2].matchAll(/\\(x[0-9A-Fa-f]{2}|.)|([^\\])/gs)) {
    if (character !== undefined) bytes.push(...new TextEncoder().encode(character));
    else bytes.push(escape[0] === "x" ? parseInt(escape.slice(1), 16) : (codes[escape] ?? escape.charCodeAt(0)));
  }
  return { form: "a text of a program", pieces: [piece(Uint8Array.from(bytes))], notes: [] };
}

function cArray(text) {
  const plain = text.replace(/\/\*.*?\*\//gs, " ").replace(/\/\/[^\n]*/g, " ");
  const found = /[{[]([^{}[\]]*)[}\]]\s*;?\s*$/.exec(plain);
  if (!found || !/^(?:\s*(?:0[xX][0-9A-Fa-f]{1,2}|\d{1,3}|'\\?.')[uU]?\s*(?:,|$))+\s*$/.test(found[1])) {
    return null;
  }
  const items = found[1].match(/0[xX][0-9A-Fa-f]{1,2}|\d{1,3}|'\\?.'/g);
  const bytes = items.map((item) => (item[0] === "'" ? item.charCodeAt(item.length - 2) : Number(item)));
  if (bytes.some((byte) => byte > 255)) return null;
  return { form: "an array", pieces: [piece(Uint8Array.from(bytes))], notes: [] };
}

// --- lines with times ----------------------------------------------------------------------------

const LOG_BEGIN = /^\s*(?:#[^\n]*\n\s*)*\(\d{1,12}(?:\.\d{1,9})?\)[ \t]+\S/;
const LOG_LINE = new RegExp(
  "^\\((\\d{1,12})(?:\\.(\\d{1,9}))?\\)(?:\\s+((?![0-9A-Fa-f]+(?:\\s|$))[^\\s#]+)(?=\\s|$))?" +
    "(?:(?:\\s+[RT]X\\s+[-B]\\s+[-E])?\\s+([0-9A-Fa-f]+)" +
    "(?:#(?:#[0-9A-Fa-f]|R[0-9A-Fa-f]?)?|\\s+\\[\\d{1,4}\\](?:\\s+remote request)?))?" +
    "\\s*((?:[0-9A-Fa-f]{2}\\s*)*)(?:'.*')?$",
);
const CAN_LINE = /^\s*[A-Za-z]\w*\s+[0-9A-Fa-f]{3,8}\s+\[\d{1,4}\]\s+((?:[0-9A-Fa-f]{2}\s*)*)(?:'.*')?$/;
const ERROR_BIT = 1 << 29;

const compact = (hex) => fromHex(hex.replace(/\s+/g, ""));

function linesOf(text, form, read) {
  const [pieces, notes] = [[], []];
  text.split("\n").forEach((line, index) => {
    const own = line.trim();
    if (!own || own.startsWith("#")) return;
    const found = read(own);
    if (found) pieces.push(found);
    else if (found === null) notes.push(`line ${index + 1} is left out: ${own.slice(0, 40)}`);
  });
  return pieces.length ? { form, pieces, notes } : null;
}

const nanoseconds = (seconds, fraction) => Number(seconds) * 1e9 + Number((fraction ?? "").padEnd(9, "0"));

function candump(text) {
  if (LOG_BEGIN.test(text)) {
    return linesOf(text, "a log", (line) => {
      const found = LOG_LINE.exec(line);
      if (!found || !(found[5] || found[4])) return null;
      if (found[4] && parseInt(found[4], 16) & ERROR_BIT) return undefined;
      return piece(compact(found[5]), nanoseconds(found[1], found[2]), found[3] ?? "");
    });
  }
  const first = text.split("\n").find((line) => line.trim());
  if (!first || !CAN_LINE.test(first)) return null;
  return linesOf(text, "a log of candump", (line) => {
    const found = CAN_LINE.exec(line);
    return found ? piece(compact(found[1])) : null;
  });
}

const TIME = new RegExp(
  "^\\s*[(\\[<]?\\s*(?:(?:(\\d{4}-\\d\\d-\\d\\d)[T ])?(\\d\\d?):(\\d\\d)(?::(\\d\\d))?|(\\d{1,12}(?=[.,]\\d)))" +
    "(?:[.,](\\d{1,9})\\d*)?Z?(?=[\\s)\\]>]|$)[)\\]>]?",
);

/** Lines of any program: a time, words such as a sender or `TX:`, and hex. */
function timedLines(text, names) {
  const first = text.split("\n").find((line) => line.trim() && !line.trim().startsWith("#"));
  if (!first || !(TIME.test(first) || hasName(first, [...names, "TX", "RX", "tx", "rx"]))) return null;
  let [days, last] = [0, 0];
  return linesOf(text, "a log", (line) => {
    const time = TIME.exec(line);
    const rest = line.slice(time ? time[0].length : 0);
    const found = /^((?:\s*(?:(?![0-9A-Fa-f]{2}(?:\s|$))[^\s]+)(?=\s))*?)[\s:>]*((?:(?:0x)?[0-9A-Fa-f]{2}[\s,]*)+)$/.exec(rest);
    if (!found) return null;
    let when = null;
    if (time?.[5]) when = nanoseconds(time[5], time[6]);
    else if (time) {
      const clock = nanoseconds(Number(time[2]) * 3600 + Number(time[3]) * 60 + Number(time[4] ?? 0), time[6]);
      if (time[1]) when = Date.parse(`${time[1]}T00:00:00Z`) * 1e6 + clock;
      else {
        if (last - clock > 43200e9) days++;
        last = clock;
        when = days * 86400e9 + clock;
      }
    }
    const words = found[1].match(/\w+/g) ?? [];
    const word = words.find((item) => names.includes(item)) ?? directionIn(words.join(" "));
    return piece(compact(found[2].replace(/0x|,/g, "")), when, word);
  });
}

/** `TX` or `RX`, as a log says who sent a line. */
const directionIn = (text) => /\b[RT]X\b/i.exec(text)?.[0].toUpperCase() ?? "";

const hasName = (line, names) => names.some((name) => new RegExp(`^\\s*${name}\\b\\W+[0-9A-Fa-f]{2}`).test(line));

// --- logic analysers -----------------------------------------------------------------------------

const cellsOf = (line) => line.split(",").map((cell) => cell.trim().replace(/^"(.*)"$/, "$1"));

/** Tables that Saleae's Logic exports: a byte in each line, with its time. */
function saleae(text) {
  const [head, ...lines] = text.trim().split("\n");
  const heads = cellsOf(head).map((name) => name.toLowerCase());
  const value = heads.findIndex((name) => name === "value" || name === "data");
  const time = heads.findIndex((name) => /^(time|start[_ ]time|start)\b/.test(name));
  const name = heads.indexOf("name");
  if (value < 0 || time < 0) return null;
  return linesOf(lines.join("\n"), "an export of a logic analyser", (line) => {
    const cells = cellsOf(line);
    const byte = byteIn(cells[value] ?? "");
    if (byte === null) return null;
    const when = Number(cells[time]);
    return piece(Uint8Array.of(byte), Number.isFinite(when) ? when * 1e9 : null, cells[name] ?? "");
  });
}

/** The byte in a cell: `0x55`, `85`, `U`, `'U' (0x55)`, `\x55`. */
function byteIn(cell) {
  const hex = /(?:0x|\\x)([0-9A-Fa-f]{1,2})/i.exec(cell);
  if (hex) return parseInt(hex[1], 16);
  if (/^\d{1,3}$/.test(cell) && Number(cell) < 256) return Number(cell);
  const named = { "\\n": 10, "\\r": 13, "\\t": 9, "\\0": 0, COMMA: 44 };
  return named[cell] ?? (cell.length === 1 ? cell.charCodeAt(0) : null);
}

/** Lines of sigrok-cli: `uart-1: 55`, or with the direction, `uart-1: TX data: 55`. */
function sigrok(text) {
  const line = /^(?:(\d+)-\d+\s+)?(\w+-\d+):(?:\s*([RT]X)(?: data)?:)?\s*([0-9A-Fa-f]{2})$/i;
  const first = text.split("\n").find((item) => item.trim());
  if (!first || !line.test(first.trim())) return null;
  return linesOf(text, "an export of sigrok", (item) => {
    const found = line.exec(item);
    return found ? piece(compact(found[4]), null, directionIn(found[3] ?? "") || found[2]) : undefined;
  });
}
