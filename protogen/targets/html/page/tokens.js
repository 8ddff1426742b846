/** Texts that come in portions, cut into lines or tokens; and hex, which is tokens in any dress. */
import { Gathered } from "./gathered.js";

/** Characters of the longest token that may go on in the next portion. */
const LONGEST = 4096;

/** Text that stands for no bytes; `line` and `column` count from 1. */
export class InputError extends Error {
  constructor(line, column, problem) {
    super(`line ${line}, column ${column}: ${problem}`);
  }
}

/** Calls `read(line, number)` for each line that has something; false leaves it out. */
export class Lines {
  constructor(out, read) {
    Object.assign(this, { out, read, rest: "", number: 0 });
  }

  feed(text, isLast) {
    const all = this.rest + text;
    let at = 0;
    for (let end = all.indexOf("\n"); end >= 0; end = all.indexOf("\n", at)) {
      this.line(all.slice(at, end));
      at = end + 1;
    }
    this.rest = all.slice(at);
    if (isLast) this.line(this.rest);
  }

  line(text) {
    const [own, number] = [text.trim(), ++this.number];
    if (!own || own[0] === "#") return;
    if (this.read(own, number) === false) this.out.leave(number, own);
  }
}

/** Calls `take(token, fail)` for each token; one that reaches the end of a portion may go on. */
export class Tokens {
  constructor(out, pattern, take, strange = (text, at) => [at, `\`${text[at]}\` can't stand here`]) {
    Object.assign(this, { out, pattern, take, strange, rest: "", line: 1, column: 1 });
  }

  feed(text, isLast) {
    const { out, pattern } = this;
    const all = this.rest + text;
    let at = 0;
    const fail = (place, problem) => {
      this.pass(all.slice(0, place));
      throw new InputError(this.line, this.column, problem);
    };
    while (at < all.length) {
      pattern.lastIndex = at;
      const found = pattern.exec(all);
      const end = at + (found?.[0].length ?? 0);
      if (!isLast && (!found || end === all.length) && all.length - at < LONGEST) break;
      if (!found) fail(...this.strange(all, at));
      this.take(found, fail);
      at = end;
    }
    this.pass(all.slice(0, at));
    this.rest = all.slice(at);
    if (out.size > (out.ends[out.ends.length - 1] ?? 0)) out.piece();
  }

  /** Count the lines of what was taken. */
  pass(text) {
    const breaks = text.split("\n");
    this.column = (breaks.length > 1 ? 1 : this.column) + breaks[breaks.length - 1].length;
    this.line += breaks.length - 1;
  }
}

// --- hex -----------------------------------------------------------------------------------------

/** Pairs of digits with something behind them; else what separates, a remark, or digits. */
const HEX = new RegExp(
  "(?:(?:0[xX]|\\\\[xX])?(?:[0-9A-Fa-f]{2})+[\\s,;:]+)+|[\\s,;:]+|#[^\\n]*|" +
    `(0[xX]|\\\\[xX]|)([0-9A-Fa-f]{1,${LONGEST}})(?![xX])`,
  "y",
);

/** Takes hex digits: `1B 02`, `1b02`, `0x1B,0x02`, `\x1b\x02`, `1B:02`. */
export function hexReader(out) {
  const take = ({ 0: all, 1: prefix, 2: digits, input, index }, fail) => {
    if (digits === undefined) {
      if (all[0] !== "#") out.digits(all);
      return;
    }
    const isSingle = digits.length === 1 && /0x/i.test(prefix);
    if (digits.length % 2 && !isSingle) fail(...odd(input, index, all));
    out.digits(isSingle ? `0${digits}` : digits);
  };
  return new Tokens(out, HEX, take, stranger);
}

export function parseHex(text) {
  const out = new Gathered();
  hexReader(out).feed(text, true);
  return out.data.slice(0, out.size);
}

function stranger(text, at) {
  const place = at + (/[0-9A-Fa-f]/.test(text[at]) ? 1 : 0);
  return [place, `\`${text[place] ?? ""}\` is no hex digit and no separator`];
}

function odd(text, at, all) {
  const next = text[at + all.length];
  if (next !== undefined && !/[\s,;:#\\0-9A-Fa-f]/.test(next)) return stranger(text, at + all.length);
  return [at, `\`${all.slice(-20)}\` has an odd number of hex digits`];
}
