/** Bytes as people have them: hex in any dress, arrays of C, candump, logs, exports of analysers. */
import { Gathered } from "./gathered.js";
import { hexReader, InputError, Lines, Tokens } from "./tokens.js";

/** Characters of a text by which its dress is known. */
export const HEAD = 1 << 16;

/** What a text holds: bytes in pieces, and their form in words. */
export function readText(text, names) {
  const { form, begin } = dressOf(text.slice(0, HEAD), names, text.length <= HEAD);
  const out = Object.assign(new Gathered(), { form });
  begin(out).feed(text, true);
  if (out.isDirected) out.notes.unshift("TX is what the side chosen sends, RX what the other sends");
  return out;
}

/** The dress of a text that begins so: its form, `begin(out)` for a reader, and if it has directions. */
export function dressOf(head, names, isWhole) {
  for (const dress of [quotedBytes, cArray, dump, candump, saleae, sigrok, timedLines]) {
    const found = dress(head, names);
    const isDirected = found && tried(found, head, isWhole);
    if (isDirected !== null) return { ...found, isDirected };
  }
  const hex = { form: "hex", begin: hexReader, isDirected: false };
  hex.begin(new Gathered()).feed(head, isWhole);
  return hex;
}

/** Whether a text that fits has two directions; null: it does not fit. */
function tried({ begin }, head, isWhole) {
  const out = new Gathered();
  try {
    begin(out).feed(head, isWhole);
  } catch (error) {
    if (!(error instanceof InputError)) throw error;
    return null;
  }
  return out.ends.length ? out.isDirected : null;
}

/** A dress of lines; `open()` gives what reads one of them into `out`. */
const inLines = (form, open) => ({
  form,
  begin: (out) => {
    const read = open();
    return new Lines(out, (line, number) => read(line, out, number));
  },
});

const firstLine = (text) => text.split("\n").find((line) => line.trim())?.trim() ?? "";

const DUMP_LINE = /^([0-9A-Fa-f]{6,16})(:?)\s+([^|]*)(\|.*)?$/;

/** Lines of `xxd` and `hexdump -C`: an offset, bytes, and characters. The offsets have to fit. */
function dump(head) {
  if (!DUMP_LINE.test(firstLine(head))) return null;
  return inLines("a dump", () => {
    let size = 0;
    return (line, out, number) => {
      const [, at, colon, rest, bar] = DUMP_LINE.exec(line) ?? [];
      const fail = () => {
        throw new InputError(number, 1, "no line of a dump, or not the next offset");
      };
      // The last line of `hexdump -C` is the size alone.
      if (parseInt(at ?? line, 16) !== size) fail();
      if (at === undefined) return;
      // Characters that `xxd` shows may be bars.
      const digits = (colon ? rest.split(/\s{2,}/)[0] : rest).replace(/\s/g, "");
      if (!(colon || bar) || !/^(?:[0-9A-Fa-f]{2})+$/.test(digits)) fail();
      out.digits(digits);
      out.piece();
      size += digits.length / 2;
    };
  });
}

// --- arrays and texts of programs ----------------------------------------------------------------

const CODES = { n: 10, r: 13, t: 9, 0: 0, a: 7, b: 8, f: 12, v: 11 };

/** The byte of an escape without its backslash. */
const escaped = (text) =>
  text.length > 1 && text[0] === "x" ? parseInt(text.slice(1), 16) : (CODES[text] ?? text.charCodeAt(0));

function quotedBytes(head) {
  const [opening, mark] = /^\s*b?(["'])/.exec(head) ?? [];
  if (!mark) return null;
  const pattern = new RegExp(`\\\\(x[0-9A-Fa-f]{2}|[^])|(${mark}\\s*;?\\s*$)|([^\\\\${mark}]+)`, "y");
  const encoder = new TextEncoder();
  return inside("a text of a program", opening.length, pattern, (out, close) => ([, escape, end, text]) => {
    if (escape !== undefined) out.byte(escaped(escape));
    else if (end) close();
    else out.bytes(encoder.encode(text));
  });
}

const COMMENT = "//[^\\n]*|/\\*[^]*?\\*/";
const ITEM = "(0[xX][0-9A-Fa-f]{1,2}|\\d{1,3}|'(?:\\\\x..|\\\\?.)')[uU]?";
const OPENING = new RegExp(`[{[](?=\\s*${ITEM}\\s*(?:,|[}\\]]\\s*;?\\s*$))`);
/** Items of an array, what stands between them and behind them; `xxd -i` tells the size as well. */
const ARRAY = new RegExp(`\\s+|${COMMENT}|${ITEM}(?=[\\s,}\\]/])|([,}\\]])|;|unsigned int \\w+ = \\d+;`, "y");

function cArray(head) {
  const plain = head.replace(new RegExp(COMMENT, "g"), (all) => " ".repeat(all.length));
  const opening = OPENING.exec(plain);
  if (!opening) return null;
  return inside("an array", opening.index + 1, ARRAY, (out, close) => {
    let isNext = true;
    return ({ 0: all, 1: item, 2: mark, index }, fail) => {
      if (mark && mark !== ",") close();
      if (mark) isNext = true;
      if (!item) return;
      const value = item[0] === "'" ? escaped(item.slice(1, -1).replace(/^\\(?=.)/, "")) : Number(item);
      if (!isNext || value > 255) fail(index, `\`${all}\` is no item of an array`);
      isNext = false;
      out.byte(value);
    };
  });
}

/** A dress of tokens behind an opening of so many characters, which is closed. */
function inside(form, opening, pattern, open) {
  const begin = (out) => {
    let [isOpen, isClosed] = [false, false];
    const tokens = new Tokens(out, pattern, open(out, () => (isClosed = true)));
    const feed = (text, isLast) => {
      if (!isOpen) tokens.pass(text.slice(0, opening));
      tokens.feed(isOpen ? text : text.slice(opening), isLast);
      isOpen = true;
      if (isLast && !isClosed) throw new InputError(tokens.line, tokens.column, "nothing closes it");
    };
    return { feed };
  };
  return { form, begin };
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

const nanoseconds = (seconds, fraction) => Number(seconds) * 1e9 + Number((fraction ?? "").padEnd(9, "0"));

function candump(head) {
  if (LOG_BEGIN.test(head)) {
    return inLines("a log", () => (line, out) => {
      const [all, seconds, fraction, name, identity, digits] = LOG_LINE.exec(line) ?? [];
      if (!all || !(digits || identity)) return false;
      if (identity && parseInt(identity, 16) & ERROR_BIT) return;
      out.digits(digits);
      out.piece(nanoseconds(seconds, fraction), name);
    });
  }
  if (!CAN_LINE.test(firstLine(head))) return null;
  return inLines("a log of candump", () => (line, out) => {
    const found = CAN_LINE.exec(line);
    if (!found) return false;
    out.digits(found[1]);
    out.piece();
  });
}

const TIME = new RegExp(
  "^\\s*[(\\[<]?\\s*(?:(?:(\\d{4}-\\d\\d-\\d\\d)[T ])?(\\d\\d?):(\\d\\d)(?::(\\d\\d))?|(\\d{1,12}(?=[.,]\\d)))" +
    "(?:[.,](\\d{1,9})\\d*)?Z?(?=[\\s)\\]>]|$)[)\\]>]?",
);

const WORDS = /^((?:\s*(?:(?![0-9A-Fa-f]{2}(?:\s|$))[^\s]+)(?=\s))*?)[\s:>]*((?:(?:0x)?[0-9A-Fa-f]{2}[\s,]*)+)$/;

/** Lines of any program: a time, words such as a sender or `TX:`, and hex. */
function timedLines(head, names) {
  const first = head.split("\n").find((line) => line.trim() && !line.trim().startsWith("#"));
  if (!first || !(TIME.test(first) || hasName(first, [...names, "TX", "RX", "tx", "rx"]))) return null;
  return inLines("a log", () => {
    const clock = clockOf();
    return (line, out) => {
      const time = TIME.exec(line);
      const found = WORDS.exec(time ? line.slice(time[0].length) : line);
      if (!found) return false;
      const words = found[1].match(/\w+/g) ?? [];
      out.digits(found[2]);
      out.piece(time && clock(time), words.find((item) => names.includes(item)) ?? directionIn(words.join(" ")));
    };
  });
}

/** The nanoseconds of what `TIME` found in lines that follow each other; days pass in between. */
function clockOf() {
  let [days, last] = [0, 0];
  return ([, date, hours, minutes, seconds, stamp, fraction]) => {
    if (stamp) return nanoseconds(stamp, fraction);
    const clock = nanoseconds(hours * 3600 + minutes * 60 + Number(seconds ?? 0), fraction);
    if (date) return Date.parse(`${date}T00:00:00Z`) * 1e6 + clock;
    if (last - clock > 43200e9) days++;
    last = clock;
    return days * 86400e9 + clock;
  };
}

/** `TX` or `RX`, as a log says who sent a line. */
const directionIn = (text) => /\b[RT]X\b/i.exec(text)?.[0].toUpperCase() ?? "";

const hasName = (line, names) => names.some((name) => new RegExp(`^\\s*${name}\\b\\W+[0-9A-Fa-f]{2}`).test(line));

// --- logic analysers -----------------------------------------------------------------------------

const cellIn = (cell = "") => cell.trim().replace(/^"(.*)"$/, "$1");

/** Tables that Saleae's Logic exports: a byte in each line, with its time. */
function saleae(head) {
  const first = firstLine(head);
  const heads = first.split(",").map((name) => cellIn(name).toLowerCase());
  const value = heads.findIndex((name) => name === "value" || name === "data");
  const time = heads.findIndex((name) => /^(time|start[_ ]time|start)\b/.test(name));
  const name = heads.indexOf("name");
  if (value < 0 || time < 0) return null;
  return inLines("an export of a logic analyser", () => (line, out) => {
    const cells = line.split(",");
    const byte = byteIn(cellIn(cells[value]));
    if (byte === null) return line === first ? undefined : false;
    const when = Number(cellIn(cells[time]));
    out.byte(byte);
    out.piece(Number.isFinite(when) ? when * 1e9 : null, cellIn(cells[name]));
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

const SIGROK = /^(?:\d+-\d+\s+)?(\w+-\d+):(?:\s*([RT]X)(?: data)?:)?\s*([0-9A-Fa-f]{2})$/i;

/** Lines of sigrok-cli: `uart-1: 55`, or with the direction, `uart-1: TX data: 55`. */
function sigrok(head) {
  if (!SIGROK.test(firstLine(head))) return null;
  return inLines("an export of sigrok", () => (line, out) => {
    const [all, name, direction, digits] = SIGROK.exec(line) ?? [];
    if (!all) return;
    out.digits(digits);
    out.piece(null, direction?.toUpperCase() ?? name);
  });
}
