/** The fields of a payload, found in its bytes one after another. */
import { reads, row } from "./cursor.js";
import { said } from "./expressions.js";
import { ByteError, decoded, floatOf, signedOf } from "./numbers.js";
import { hexDigits, hexOf, latin1, quoted } from "./octets.js";
import { integerReading, physical, valueName } from "./readings.js";

/** The values read so far, in front of those of the records around. */
class Scope {
  constructor(around = null, own = new Map()) {
    this.around = around;
    this.own = own;
  }

  look(name) {
    const [first, ...others] = name.split(".");
    let scope = this;
    while (scope && !scope.own.has(first)) scope = scope.around;
    let found = scope?.own.get(first);
    for (const step of others) found = found instanceof Map ? found.get(step) : undefined;
    return found;
  }

  inside(name) {
    const inner = new Scope(this);
    this.own.set(name, inner.own);
    return inner;
  }
}

/**
 * A row for each field, member and element, up to the first that has no bytes.
 *
 * `parts` has the numbers of the frame, which some fields are.
 */
export function dissect(message, cursor, enums, parts) {
  const reader = new PayloadReader(cursor, enums, parts);
  reader.record(message.steps, "", new Scope());
  return reader.rows;
}

class PayloadReader {
  constructor(cursor, enums, parts) {
    this.cursor = cursor;
    this.enums = enums;
    this.parts = parts;
    this.isShort = false;
    this.rows = [];
  }

  record(steps, prefix, scope) {
    for (const step of steps ?? []) this.step(step, `${prefix}${step.name ?? ""}`, scope);
  }

  step(step, path, scope) {
    if (this.isShort) return;
    const inner = step.const === undefined ? step.step : step.step && { ...step.step, const: step.const };
    if (step.packing) this.packed(step, path, scope);
    else if (step.kind === "record") this.record(step.steps, `${path}.`, scope.inside(step.name ?? ""));
    else if (step.kind === "repeat") this.elements(step, path, scope);
    else if (step.kind === "choose") this.choose(step, path, scope);
    else if (step.kind === "constant") this.step(inner, path, scope);
    else if (step.kind === "optional") {
      if (step.when === undefined ? this.cursor.left : said(step.when, (n) => scope.look(n))) {
        this.step(inner, path, scope);
      }
    } else if (step.kind === "region") this.region(step, path, scope);
    else if (step.kind === "part") this.part(step, path, scope);
    else this.scalar(step, path, scope);
  }

  /** A number of the frame, of which the payload has no bytes; unknown ones are 0. */
  part(step, path, scope) {
    const value = this.parts.get(step.part) ?? 0n;
    scope.own.set(step.name, value);
    const found = this.cursor.take(0, path, `part ${step.part}`);
    this.rows.push(reads(found, value, this.meaning(step, value), this.fault(step, value)));
  }

  count(count, scope) {
    if (count.by === undefined) return count.known ?? null;
    const found = said(count.by, (name) => scope.look(name)) ?? 0n;
    return found > 0n ? Number(found) : 0;
  }

  region(step, path, scope) {
    const size = this.count(step.region, scope) ?? 0;
    const outside = this.cursor;
    const there = Math.min(size, outside.left);
    this.cursor = outside.part(size);
    this.step(step.step, path, scope);
    const left = size - there + this.cursor.left;
    if (left && !this.isShort) {
      const fault = `${left} of the ${size} bytes are left over`;
      const found = this.cursor.take(left, path, "bytes", { fault });
      this.isShort = found.cut;
      this.rows.push(found);
    }
    this.cursor = outside;
  }

  elements(step, path, scope) {
    if (step.count.mark !== undefined) {
      this.upToLast(step, path, scope);
      return;
    }
    let count = this.count(step.count, scope);
    if (step.count.tail) count = this.cursor.elements(step.count.tail);
    let index = 0;
    while (!this.isShort && (count === null ? this.cursor.left : index < count)) {
      this.step(elementOf(step.element, index), `${path}[${index}]`, scope);
      index++;
    }
  }

  /** Elements up to the one that says that it is the last; one at least. */
  upToLast(step, path, scope) {
    for (let index = 0; index < step.count.greatest; index++) {
      this.step(step.element, `${path}[${index}]`, scope);
      if (this.isShort) return;
      const members = new Scope(scope, scope.own.get(step.element.name ?? ""));
      if (said(step.count.mark, (name) => members.look(name))) return;
    }
    const fault = `none of ${step.count.greatest} elements says that it is the last`;
    this.rows.push(this.cursor.take(0, path, step.label, { fault }));
  }

  choose(step, path, scope) {
    const value = said(step.expression, (name) => scope.look(name));
    const cases = step.cases ?? [];
    const fits = cases.find((item) => item.value !== undefined && BigInt(item.value) === value);
    const found = value === null ? undefined : (fits ?? cases.find((item) => item.isElse));
    if (found) {
      this.step(found.step, path, scope);
      return;
    }
    if (!this.cursor.left) return;
    const isWrong = value !== null ? !step.rest : !step.rest;
    const fault = isWrong ? `\`${step.text}\` has no case ${value === null ? "None" : value}` : "";
    this.rows.push(this.cursor.take(this.cursor.left, path, "bytes", { fault }));
  }

  /** A row for the bytes of packed numbers, and one for each of the numbers. */
  packed(step, path, scope) {
    const packing = step.packing.width ? filledRun(step.packing, this.cursor.left) : step.packing;
    const isRecord = step.kind === "record";
    let found = this.cursor.take(packing.size, path, `packed ${packing.order}`);
    found = { ...found, meaning: `${packing.bits} bits`, isRun: true };
    const last = found.bytes[found.bytes.length - 1] ?? 0;
    if (!found.cut && last & (packing.padding ?? 0)) {
      found.fault = "the bits behind the last number have to be zero";
    }
    this.isShort = found.cut;
    this.rows.push(found);
    if (found.cut) return;
    const members = new Map();
    scope.own.set(step.name ?? "", members);
    for (const item of packing.numbers ?? []) {
      const own = this.bits(item, packing, found, isRecord ? `${path}.` : path);
      this.rows.push(own);
      members.set(item.name ?? "", own.value);
    }
  }

  bits(item, packing, run, base) {
    const { type } = item;
    const first = item.first;
    const end = first + type.bits - 1;
    const index = item.index === undefined ? "" : `[${item.index}]`;
    const isLeast = packing.order === "lsb_first";
    const bytes = isLeast ? [...run.bytes].reverse() : run.bytes;
    const whole = bytes.reduce((raw, byte) => (raw << 8n) | BigInt(byte), 0n);
    const low = isLeast ? first : 8 * bytes.length - end - 1;
    const raw = BigInt.asUintN(type.bits, whole >> BigInt(low));
    const value = signedOf(type, raw);
    const place = end === first ? `bit ${end}` : `bits ${first}..${end}`;
    const found = row({
      offset: run.offset + Math.floor(first / 8),
      bits: raw.toString(2).padStart(type.bits, "0"),
      path: `${base}${item.name ?? ""}${index}`,
      type: `${type.label}, ${place}`,
      field: item,
    });
    return reads(found, value, this.meaning(item, value), this.fault(item, value));
  }

  // --- values ------------------------------------------------------------------------------------

  scalar(step, path, scope) {
    const size = this.sizeOf(step, scope) ?? this.cursor.left;
    let found = this.cursor.take(size, path, step.type.label, { field: step });
    this.isShort = found.cut;
    if (!found.cut) found = this.read(step, found);
    if (typeof found.value === "bigint") scope.own.set(step.name ?? "", found.value);
    this.rows.push(found);
  }

  /** Bytes of a value, with a terminator; null: as many as there are. */
  sizeOf(step, scope) {
    const { count } = step;
    if (!count) return this.numberSize(step.type);
    if (count.until !== undefined) return this.cursor.sizeTo(count.until, 0) + 1;
    if (count.between) {
      const { separator, leads, rest } = count.between;
      return rest ? null : this.cursor.sizeTo(separator, leads ? 1 : 0);
    }
    return this.count(count, scope);
  }

  numberSize(type) {
    const form = type.text;
    if (!form || form.alphabet) return type.size;
    return form.separator === undefined ? null : this.cursor.sizeTo(form.separator, form.leads ? 1 : 0);
  }

  read(step, found) {
    const { type, count } = step;
    if (step.sevenBit && found.bytes.some((byte) => byte > 0x7f)) {
      return { ...found, fault: "has a byte of more than 7 bits" };
    }
    if (count) {
      if (count.until !== undefined) found.fault = boundsFault(count, found.bytes.length - 1);
      if (count.between) found.fault = betweenFault(count, found.bytes);
      return type.kind === "text" ? text(step, found) : octets(step, found);
    }
    try {
      const value = decoded(type, found.bytes);
      if (type.kind === "float") {
        const real = floatOf(type, value);
        return reads(found, real, physical(step, real));
      }
      return reads(found, value, this.meaning(step, value), this.fault(step, value));
    } catch (error) {
      if (!(error instanceof ByteError)) throw error;
      return { ...found, fault: error.message };
    }
  }

  meaning(field, value) {
    const text = integerReading(field, field.type, value, this.enums);
    if (text !== String(value)) return text;
    return field.type.enum ? "a value without a name" : "";
  }

  fault(field, value) {
    const due = field.const;
    const isNumber = ["number", "boolean"].includes(typeof due) || /^-?\d+$/.test(due);
    if (due !== undefined && isNumber && value !== BigInt(due)) return `must be ${pythonConstant(due)}`;
    const isClosed = this.enums[field.type.enum]?.closed;
    if (isClosed && valueName(field, field.type, value, this.enums) === undefined) {
      return "is none of the values that there are";
    }
    return "";
  }
}

/** The run of as many numbers as so many bytes hold, each like the first. */
function filledRun({ order, width, numbers: [first] }, size) {
  const count = Math.floor((8 * size) / width);
  const bits = count * width;
  const own = Math.ceil(bits / 8);
  const left = 8 * own - bits;
  const mask = 2 ** left - 1;
  const padding = order === "lsb_first" ? (mask << (8 - left)) & 0xff : mask;
  const numbers = Array.from({ length: count }, (_, index) => ({ ...first, index, first: index * width }));
  return { order, bits, size: own, padding, numbers };
}

const pythonConstant = (due) => (typeof due === "boolean" ? (due ? "True" : "False") : String(due));

/** A constant array has a value for each element. */
function elementOf(element, index) {
  return Array.isArray(element.const) ? { ...element, const: element.const[index] } : element;
}

function octets(step, found) {
  const due = step.const;
  const isOther = due instanceof Uint8Array && hexOf(due) !== hexOf(found.bytes);
  return isOther ? { ...found, fault: `must be ${hexOf(due)}` } : found;
}

function boundsFault(count, size) {
  const text = `has ${size} bytes in front of the terminator`;
  if (size > count.greatest) return `${text}, at most ${count.greatest}`;
  return size < count.least ? `${text}, at least ${count.least}` : "";
}

function betweenFault(count, bytes) {
  const { separator, leads, characters } = count.between;
  if (leads && bytes[0] !== separator) return "the separator in front is missing";
  const text = bytes.slice(leads ? 1 : 0);
  if (text.length < count.least || text.length > count.greatest) {
    return `has ${text.length} characters, and not ${count.least} to ${count.greatest}`;
  }
  const wrong = text.find((byte) => !characters.includes(String.fromCharCode(byte)));
  return wrong === undefined ? "" : `${hexDigits(wrong)} is no character of it`;
}

function text(step, found) {
  let shown = latin1(found.bytes);
  const { count, type } = step;
  if (count.between?.leads) shown = shown.slice(1);
  if (count.until !== undefined) shown = shown.slice(0, -1);
  if (type.form) {
    const plain = padded(type.form, found.bytes);
    if (plain.fault) return { ...found, fault: plain.fault };
    shown = plain.text;
  }
  const due = step.const;
  const isOther = typeof due === "string" && shown !== due;
  return reads(found, shown, "", isOther ? `must be ${quoted(due)}` : "");
}

/** A text without its padding; of bytes that are no character, what is wrong. */
function padded([padding, bits, shift, add], bytes) {
  const codes = bytes.map((byte) => (byte - add) / 2 ** shift);
  const isCode = (code) => Number.isInteger(code) && code >= 0 && code < 2 ** bits && (code || !padding);
  const wrong = codes.findIndex((code) => !isCode(code));
  if (wrong >= 0) return { fault: `${hexDigits(bytes[wrong])} is no character of this text` };
  while (codes.length && codes[codes.length - 1] === padding) codes.pop();
  return { text: latin1(codes) };
}
