/** A frame taken apart, byte by byte: the rows that `protogen explain` shows. */
import { Cursor, reads, row } from "./cursor.js";
import { dissect } from "./dissect.js";
import { ByteError, charactersOf, decoded, encoded } from "./numbers.js";
import { hexOf, quoted, startsWith } from "./octets.js";
import { holdsSize, isToldBy } from "./plans.js";
import { character } from "./readings.js";
import { unstuff } from "./wire.js";

const FULL_GROUP = 254;
const SURPLUS = "nothing is due here";
const NOT_KNOWN = "left, as what is behind the known fields is";
const LEFT_OUT = "left out, as zeros at the end are";

/** What each byte of `data` stands for, which `sender` is said to have sent. */
export function annotate(plans, sender, frame, data, told = {}) {
  const wire = unstuff(sender, frame, data);
  const first = new FrameReader(plans, sender, frame, wire, told);
  const rows = first.rowsOf();
  if (!sender.looksAhead) return rows;
  // What is not sent follows from the identity, and a field may be a part behind the payload.
  return new FrameReader(plans, sender, frame, wire, told, first.identity, first.numbers).rowsOf();
}

class FrameReader {
  constructor(plans, sender, frame, wire, told, identity = null, numbers = new Map()) {
    this.plans = plans;
    this.sender = sender;
    this.frame = frame;
    this.wire = wire;
    this.told = told;
    this.knownIdentity = identity;
    this.cursor = new Cursor(wire.units, 0);
    this.rows = [];
    this.found = new Map();
    this.numbers = new Map(numbers);
    this.size = this.cursor.left;
  }

  rowsOf() {
    for (const part of this.sender.parts) {
      if (part.name === this.sender.coded) this.code(this.wire.code);
      if (!this.hasEnded) this.part(part);
    }
    this.leftovers();
    return this.rows;
  }

  code(code) {
    if (!code.length) return;
    const isFull = code[0] > FULL_GROUP;
    const meaning = isFull
      ? `COBS: ${FULL_GROUP} bytes without a zero`
      : `COBS: the next zero or the end is ${code[0]} bytes on`;
    this.cursor.skip(code.length);
    this.rows.push(this.bare(code, meaning));
  }

  part(part) {
    const start = this.rows.length;
    if (part.kind === "virtual") return this.virtual(part);
    if (part.kind === "told") return this.toldPart(part);
    if (part.kind === "payload") this.rows.push(...this.payload(part));
    else if (this.isAbsent(part)) {
      this.found.set(part.name, { content: [], wire: [] });
      return undefined;
    } else {
      const found = this.fixed(part);
      this.rows.push(found);
      if (part.kind === "bits") this.rows.push(...this.bits(part, found));
    }
    const rows = this.rows.slice(start);
    const content = rows.flatMap((item) => item.bytes);
    this.found.set(part.name, { content, wire: rows.flatMap((item) => item.wire) });
    return undefined;
  }

  isAbsent(part) {
    return Boolean(part.optional) && !this.found.get(this.sender.payload)?.content.length;
  }

  toldPart(part) {
    const value = BigInt(this.told[part.name] ?? this.assumed(part));
    const found = this.cursor.take(0, part.name, part.type.label);
    if (part.isLength) {
      const own = this.number(part, value, found);
      this.rows.push({ ...own, meaning: `${own.meaning}; told, not sent` });
      return;
    }
    this.numbers.set(part.name, value);
    this.rows.push(reads(found, value, "told, not sent"));
  }

  /** What a part is where nothing was told: a length is that of the bytes. */
  assumed(part) {
    if (!part.isLength) return part.default ?? 0;
    const { base, optional } = this.sender.length;
    const payload = Math.max(0, this.size - this.sender.around);
    return base + (payload ? payload + optional : 0);
  }

  virtual(part) {
    const message = this.candidates()[0];
    const value = message === undefined ? part.default : (this.plan(message).virtual?.[part.name] ?? part.default);
    const found = this.cursor.take(0, part.name, part.type.label);
    if (value === undefined || value === null) {
      this.rows.push({ ...found, meaning: "not sent, and unknown" });
      return;
    }
    const bytes = [...encoded(part.type, value)];
    this.found.set(part.name, { content: bytes, wire: bytes });
    const shown = part.type.isText ? `${quoted(charactersOf(part.type, value))} ` : "";
    this.rows.push(reads(found, BigInt(value), `${shown}not sent`));
  }

  get hasEnded() {
    if (this.cursor.left) return false;
    return this.wire.rest.length > 0 || Boolean(this.rows[this.rows.length - 1]?.cut);
  }

  // --- parts of a fixed size ---------------------------------------------------------------------

  fixed(part) {
    if (part.kind === "literal") {
      const found = this.cursor.take(part.size, part.name, "literal");
      if (startsWith(part.bytes, found.bytes)) return found;
      return { ...found, fault: `must be ${hexOf(part.bytes)}` };
    }
    const found = this.cursor.take(part.size, part.name, part.type.label, { part });
    if (found.cut) return found;
    let value;
    try {
      value = decoded(part.type, found.bytes);
    } catch (error) {
      if (!(error instanceof ByteError)) throw error;
      return { ...found, fault: error.message };
    }
    if (part.kind === "sum") return this.checksum(part, reads(found, value, ""));
    if (part.kind !== "bits") return this.number(part, value, found);
    const [mask, due] = [BigInt(part.mask ?? 0), BigInt(part.fixed ?? 0)];
    const hex = (number) => number.toString(16).toUpperCase();
    const fault = (value & mask) === due ? "" : `bits ${hex(mask)} must be ${hex(due)}`;
    if (part.whole && !fault) return this.mirror(part.whole, value, found);
    return reads(found, value, "bits that are parts", fault);
  }

  /** The parts that are bits of one that was read, which have no bytes of their own. */
  bits(part, found) {
    if (typeof found.value !== "bigint") return [];
    return (part.bits ?? []).map((member) => {
      const value = decoded(member.type, found.bytes);
      const bits = value.toString(2).padStart(member.type.bits, "0");
      const own = row({ offset: found.offset, path: member.name, type: member.type.name, bits, part: member });
      if (member.kind === "mirror") return this.mirror(member, value, own);
      if (member.kind === "sum") return this.checksum(member, reads(own, value, ""));
      return this.number(member, value, own);
    });
  }

  mirror(part, value, found) {
    const number = this.numbers.get(part.of);
    const due = number === undefined ? null : number ^ BigInt(part.flips ?? 0);
    const fault = value === due ? "" : `must be ${due}, as ${part.of} is ${number}`;
    return reads(found, value, part.meaning, due === null ? "" : fault);
  }

  number(part, value, found) {
    this.numbers.set(part.name, value);
    let fault = holds(part, value) ? "" : `must be ${part.allowed}`;
    if (part.words) {
      const isWord = part.values.some((item) => BigInt(item) === value);
      fault = isWord ? "" : `must be ${part.words.join(" or ")}`;
    }
    let meaning = part.type.role === "char" ? character(value) : "";
    if (part.type.isText) meaning = quoted(charactersOf(part.type, value));
    if (part.role === "length") {
      fault = this.disagrees(part, value) || fault;
      meaning = part.meaning;
    } else if (part.role === "identity") {
      meaning = [meaning, this.namesOf(part)].filter(Boolean).join(" ");
    }
    return reads(found, value, meaning, fault);
  }

  disagrees(part, value) {
    const further = this.sender.further[part.name];
    const first = further && this.numbers.get(part.agrees);
    const payload = first === undefined ? null : this.payloadOf(first);
    if (!further || payload === null) return "";
    const due = further.base + (payload ? payload + further.optional : 0);
    return value === BigInt(due) ? "" : `must be ${due}, as ${part.agrees} is ${first}`;
  }

  namesOf(part) {
    const { identity } = this.sender;
    if (part.name !== identity[identity.length - 1]) return "";
    return this.candidates().join(" or ") || "no message has this identity";
  }

  checksum(part, summed) {
    const found = { ...summed, meaning: part.meaning };
    const covers = part.covers ?? [];
    const unknown = this.sender.virtual.find((name) => covers.includes(name) && !this.found.has(name));
    if (unknown && this.identity) {
      const fault = `the identity is unknown, and so is ${unknown}, which ${part.name} covers`;
      return { ...found, fault };
    }
    if (covers.some((name) => !this.found.has(name))) return found;
    const pieces = covers.map((name) => this.found.get(name));
    const covered = pieces.flatMap((piece) => (part.overWire ? piece.wire : piece.content));
    const { algorithm } = this.frame.sums[part.sum];
    const result = BigInt(algorithm.compute(Uint8Array.from(covered), 0, covered.length));
    if (part.type.low !== undefined) {
      const due = BigInt.asUintN(part.type.bits, result >> BigInt(part.lowest ?? 0));
      return found.value === due ? found : { ...found, fault: `${part.name} is ${found.value}, not ${due}` };
    }
    const due = hexOf(encoded(part.type, result)).toLowerCase();
    const own = hexOf(found.bytes).toLowerCase();
    return own === due ? found : { ...found, fault: `${part.name} is ${own}, not ${due}` };
  }

  // --- the payload -------------------------------------------------------------------------------

  plan(name) {
    return this.plans.messages[name];
  }

  payload(part) {
    const size = this.payloadSize(part);
    const inside = this.cursor.part(size);
    const message = this.message(size);
    const isCut = message !== undefined && Boolean(this.plan(message).canBeCut) && Boolean(this.sender.isCut);
    let rows = [];
    if (message !== undefined) rows = this.dissected(this.plan(message), inside, isCut);
    else if (size) rows = [inside.take(size, part.name, "bytes")];
    if (inside.left) {
      const rest = inside.take(inside.left, part.name, "bytes", { fault: isCut ? "" : SURPLUS });
      rows.push(rest.fault ? rest : { ...rest, meaning: NOT_KNOWN });
    }
    return rows.length ? rows : [{ ...inside.take(0, part.name, ""), meaning: "empty" }];
  }

  /** The rows of a payload; zeros that the frame leaves out have values and no bytes. */
  dissected(message, inside, isCut) {
    const { enums } = this.plans;
    const size = inside.left;
    const own = message.sizes[1];
    if (isCut && message.cutSize !== undefined && size > own) {
      return dissect(message, inside.part(own), enums, this.numbers);
    }
    const missing = own - size;
    if (missing <= 0 || !this.sender.isTrimmed) return dissect(message, inside, enums, this.numbers);
    const { offset } = inside;
    const zeros = Array.from({ length: missing }, () => ({ byte: 0, wire: [] }));
    const filled = new Cursor([...inside.rest(), ...zeros], offset);
    return asSent(dissect(message, filled, enums, this.numbers), size);
  }

  payloadOf(value) {
    const { length } = this.sender;
    const over = Number(value) - length.base;
    if (over === 0) return 0;
    return over - length.optional > 0 ? over - length.optional : null;
  }

  payloadSize(part) {
    const { parts, length } = this.sender;
    const behind = parts.slice(parts.indexOf(part) + 1);
    if (!length || this.sender.lengthOverWire || !this.numbers.has(length.name)) {
      return this.sizeWithoutLength(behind);
    }
    return Math.min(this.payloadOf(this.numbers.get(length.name)) ?? 0, this.cursor.left);
  }

  sizeWithoutLength(behind) {
    const message = this.plan(this.candidates()[0]);
    const last = behind[behind.length - 1];
    const isCut = last?.kind === "literal" && !this.cursor.endsWith(last.bytes);
    if (message && message.sizes[0] === message.sizes[1] && isCut) {
      return Math.min(message.sizes[0], this.cursor.left);
    }
    const size = behind.reduce((sum, part) => sum + (part.size ?? 0), 0);
    return Math.max(0, this.cursor.left - size);
  }

  message(size) {
    const candidates = this.candidates();
    const fitting = candidates.filter((name) => holdsSize(this.plan(name).sizes, size));
    const yielded = fitting.filter((name) => !(name in this.sender.hidden));
    return [...yielded, ...fitting, ...candidates][0];
  }

  candidates() {
    const identity =
      this.knownIdentity ?? this.sender.identity.map((name) => this.numbers.get(name) ?? -1n);
    return this.sender.messages.filter((name) => isToldBy(this.plan(name), identity));
  }

  get identity() {
    const names = this.sender.identity;
    if (this.knownIdentity || names.some((name) => !this.numbers.has(name))) return this.knownIdentity;
    return names.map((name) => this.numbers.get(name));
  }

  // --- what is left ------------------------------------------------------------------------------

  leftovers() {
    const { rest, fault, behind } = this.wire;
    if (this.cursor.left) {
      this.rows.push(this.cursor.take(this.cursor.left, "", "", { fault: SURPLUS }));
    }
    if (rest.length || fault) this.rows.push(this.bare(rest, fault ? "" : "stands for no byte", fault));
    if (behind.length) this.rows.push(this.bare(behind.flatMap((unit) => unit.wire)));
  }

  bare(wire, meaning = "", fault = "") {
    const offset = this.rows.reduce((sum, item) => sum + item.wire.length, 0);
    return row({ offset, wire, meaning, fault });
  }
}

function holds(part, value) {
  if (part.between) {
    const [first, last] = part.between;
    return encoded(part.type, value).every((code) => first <= code && code <= last);
  }
  return BigInt(part.least) <= value && value <= BigInt(part.greatest);
}

/** The rows of a payload that was filled up, without the bytes behind the first `size`. */
function asSent(rows, size) {
  let left = size;
  return rows.map((item) => {
    const sent = item.bytes.slice(0, left);
    left = Math.max(0, left - item.bytes.length);
    if (sent.length === item.bytes.length) return item;
    const meaning = [item.meaning, sent.length ? "" : LEFT_OUT].filter(Boolean).join("; ");
    return { ...item, bytes: sent, meaning };
  });
}
