/** Writes the values of a payload, one after another. Generated functions call it. */

import { NO_BYTES } from "./bytes.js";
import { EncodeError, joined, spelled } from "./errors.js";
import type { Value } from "./numbers.js";
import { same, shown, type Step, type TextForm } from "./reader.js";

const WORD_BYTES = new Uint8Array(8);
const WORD = new DataView(WORD_BYTES.buffer);
const GREATEST_FLOAT32 = (2 - 2 ** -23) * 2 ** 127;

/** How many values a byte has. */
type Base = 128 | 256;

/** The greatest unsigned integer of so many bits. */
function greatestOf(bits: number): number {
  return bits < 32 ? (1 << bits) - 1 : 2 ** bits - 1;
}

/**
 * Bytes of a payload so far. Each method appends a value, or throws an EncodeError.
 *
 * There may be room in front of the payload, for the parts of the frame that stand there.
 */
export class Writer {
  /** What is written into where nobody knows how much it will be. */
  private scratch: Uint8Array = new Uint8Array(256);
  bytes: Uint8Array = this.scratch;
  /** Bytes so far, those in front of the payload among them. */
  size = 0;
  /** With it, values that the schema forbids are refused, even where they fit the wire. */
  strict = true;
  /** Values of the fields that are parts of the frame, by the names of the parts. */
  held: Record<string, Value> = {};
  private readonly path: Step[] = [];

  /**
   * Begin another payload behind so many bytes.
   *
   * With a size, all that will be written has so many bytes.
   */
  restart(strict: boolean, from: number, size: number): this {
    this.strict = strict;
    this.bytes = size ? new Uint8Array(size) : this.scratch;
    this.size = 0;
    this.room(from);
    if (this.path.length) this.path.length = 0;
    return this;
  }

  /** All that was written. */
  taken(): Uint8Array {
    return this.bytes === this.scratch ? this.bytes.slice(0, this.size) : this.bytes;
  }

  /** The error of a field. */
  error(step: Step, problem: string): EncodeError {
    return new EncodeError(joined([...this.path, step]), problem);
  }

  enter(step: Step): void {
    this.path.push(step);
  }

  leave(): void {
    this.path.pop();
  }

  /** The place of so many more bytes. */
  room(size: number): number {
    const at = this.size;
    this.size = at + size;
    if (this.size > this.bytes.length) this.grow();
    return at;
  }

  private grow(): void {
    const larger = new Uint8Array(Math.max(2 * this.bytes.length, this.size));
    larger.set(this.bytes);
    this.bytes = this.scratch = larger;
  }

  /** Leave a number to the frame, whose part it is. */
  part(name: string, value: Value): void {
    this.held[name] = value;
  }

  // --- checks --------------------------------------------------------------------------------

  /** An integer that the wire can hold. */
  int(value: unknown, low: number, high: number, step: Step): number {
    if (typeof value === "number" && value >= low && value <= high && Number.isInteger(value)) {
      return value;
    }
    throw this.noInteger(value, low, high, step);
  }

  private noInteger(value: unknown, low: number, high: number, step: Step): EncodeError {
    if (typeof value === "number" && Number.isInteger(value)) {
      return this.error(step, `${value} is not in ${low}..${high}`);
    }
    return this.error(step, `must be an integer, not ${shown(value)}`);
  }

  /** An integer of more than 53 bits that the wire can hold. */
  big(value: unknown, low: bigint, high: bigint, step: Step): bigint {
    if (typeof value !== "bigint") {
      throw this.error(step, `must be a bigint, not ${shown(value)}`);
    }
    if (value < low || value > high) throw this.error(step, `${value} is not in ${low}..${high}`);
    return value;
  }

  /** A value in the range of the schema, or a special one. */
  ranged<T extends number | bigint>(
    value: T,
    least: NoInfer<T> | null,
    greatest: NoInfer<T> | null,
    special: readonly NoInfer<T>[],
    step: Step,
  ): T {
    // Not-a-number is in no range that has a bound.
    const isIn = (least === null || value >= least) && (greatest === null || value <= greatest);
    if (isIn || !this.strict || special.includes(value)) return value;
    throw this.error(step, `${value} is not in ${least ?? ""}..${greatest ?? ""}`);
  }

  /** A value out of a closed enum. */
  one<T extends number | bigint>(value: number | bigint, values: readonly T[], step: Step): T {
    if (!values.includes(value as T)) {
      throw this.error(step, `${value} has no name; there are ${values.join(", ")}`);
    }
    return value as T;
  }

  /** A truth value as a byte. */
  bool(value: unknown, step: Step): void {
    this.byte(this.truth(value, step));
  }

  /** A truth value; 0 and 1 are taken as well. */
  truth(value: unknown, step: Step): number {
    if (value === true || value === 1) return 1;
    if (value === false || value === 0) return 0;
    throw this.error(step, `must be false or true, not ${shown(value)}`);
  }

  /** A float that its bits can hold. */
  real(value: unknown, bits: 32 | 64, step: Step): number {
    if (typeof value !== "number") throw this.error(step, `must be a number, not ${shown(value)}`);
    if (bits === 32 && Number.isFinite(value) && Math.abs(value) > GREATEST_FLOAT32) {
      throw this.error(step, `${value} is too large for 32 bits`);
    }
    return value;
  }

  /** A constant, which needs not be given. */
  constant<const T>(value: unknown, due: T, step: Step): T {
    if (value !== undefined && value !== null && !same(value, due)) {
      throw this.error(step, `must be ${shown(due)}, not ${shown(value)}`);
    }
    return due;
  }

  /** A struct. */
  // Any: its members are checked one by one.
  record(value: unknown, step: Step): any {
    if (typeof value !== "object" || value === null) {
      throw this.error(step, `must be an object, not ${shown(value)}`);
    }
    return value;
  }

  /** A list of `least` to `greatest` elements. */
  // Any: they are checked one by one.
  list(value: unknown, least: number, greatest: number, step: Step): readonly any[] {
    if (!Array.isArray(value) && !ArrayBuffer.isView(value)) {
      throw this.error(step, `must be a list, not ${shown(value)}`);
    }
    const items = value as unknown as readonly unknown[];
    this.count(items.length, least, greatest, "elements", step);
    return items;
  }

  /** A number of elements or bytes. */
  count(count: number, least: number, greatest: number, what: string, step: Step): void {
    if (count >= least && count <= greatest) return;
    const due = least === greatest ? `exactly ${least}` : `${least} to ${greatest}`;
    throw this.error(step, `needs ${due} ${what}, not ${count}`);
  }

  /** Nothing: the value of what is not there, or has no bytes. */
  nothing(value: unknown, step: Step): void {
    if (value !== null && value !== undefined) {
      throw this.error(step, `must be null, not ${shown(value)}`);
    }
  }

  /** Refuse a value behind one that is left out. */
  behind(front: unknown, name: string, step: Step): void {
    if (front === null || front === undefined) {
      throw this.error(step, `must be null, as ${name} in front of it is left out`);
    }
  }

  /** Refuse an element that says that it is the last where it is not, or the reverse. */
  last(isLast: boolean, items: readonly unknown[], index: number, by: string): void {
    if (isLast !== (index === items.length - 1)) {
      throw this.error(index, `the last element, and no other, is the last by ${by}`);
    }
  }

  /** The error of a selector without a case. */
  noCase(value: number | bigint, by: string, step: Step): EncodeError {
    return this.error(step, `there is no case for ${by} = ${value}`);
  }

  // --- integers ------------------------------------------------------------------------------

  u8(value: unknown, step: Step): void {
    this.byte(this.int(value, 0, 0xff, step));
  }

  i8(value: unknown, step: Step): void {
    this.byte(this.int(value, -0x80, 0x7f, step));
  }

  u16(value: unknown, step: Step): void {
    const number = this.int(value, 0, 0xffff, step);
    const at = this.room(2);
    this.bytes[at] = number;
    this.bytes[at + 1] = number >> 8;
  }

  i16(value: unknown, step: Step): void {
    const number = this.int(value, -0x8000, 0x7fff, step);
    const at = this.room(2);
    this.bytes[at] = number;
    this.bytes[at + 1] = number >> 8;
  }

  u16be(value: unknown, step: Step): void {
    const number = this.int(value, 0, 0xffff, step);
    const at = this.room(2);
    this.bytes[at] = number >> 8;
    this.bytes[at + 1] = number;
  }

  i16be(value: unknown, step: Step): void {
    const number = this.int(value, -0x8000, 0x7fff, step);
    const at = this.room(2);
    this.bytes[at] = number >> 8;
    this.bytes[at + 1] = number;
  }

  u32(value: unknown, step: Step): void {
    this.four(this.int(value, 0, 0xffffffff, step));
  }

  i32(value: unknown, step: Step): void {
    this.four(this.int(value, -0x80000000, 0x7fffffff, step));
  }

  u32be(value: unknown, step: Step): void {
    this.fourBe(this.int(value, 0, 0xffffffff, step));
  }

  i32be(value: unknown, step: Step): void {
    this.fourBe(this.int(value, -0x80000000, 0x7fffffff, step));
  }

  /** The lowest eight bits. */
  byte(value: number): void {
    const at = this.room(1);
    this.bytes[at] = value;
  }

  private four(value: number): void {
    const at = this.room(4);
    const { bytes } = this;
    bytes[at] = value;
    bytes[at + 1] = value >> 8;
    bytes[at + 2] = value >> 16;
    bytes[at + 3] = value >> 24;
  }

  private fourBe(value: number): void {
    const at = this.room(4);
    const { bytes } = this;
    bytes[at] = value >> 24;
    bytes[at + 1] = value >> 16;
    bytes[at + 2] = value >> 8;
    bytes[at + 3] = value;
  }

  /** An unsigned integer in bytes of 8 bits or, if `base` is 128, of 7. */
  uint(value: unknown, size: number, bits: number, little: boolean, base: Base, step: Step): void {
    this.lowest(this.int(value, 0, greatestOf(bits), step), size, bits, little, base);
  }

  /** The same of a signed one. */
  sint(value: unknown, size: number, bits: number, little: boolean, base: Base, step: Step): void {
    const greatest = greatestOf(bits - 1);
    this.lowest(this.int(value, -greatest - 1, greatest, step), size, bits, little, base);
  }

  /** The lowest bits of an integer. */
  private lowest(value: number, size: number, bits: number, little: boolean, base: Base): void {
    const first = this.room(size);
    const { bytes } = this;
    const next = little ? 1 : -1;
    let at = little ? first : first + size - 1;
    if (bits <= 32) {
      const shift = base === 128 ? 7 : 8;
      let left = value & greatestOf(bits);
      for (let count = 0; count < size; count++, at += next) {
        bytes[at] = left & (base - 1);
        left >>>= shift;
      }
      return;
    }
    let rest = value < 0 ? value + 2 ** bits : value;
    for (let count = 0; count < size; count++, at += next) {
      bytes[at] = rest % base;
      rest = Math.floor(rest / base);
    }
  }

  /** The same of more than 53 bits. */
  ubig(value: bigint, size: number, bits: number, little: boolean, base: Base): void {
    const at = this.room(size);
    const shift = base === 128 ? 7n : 8n;
    let rest = BigInt.asUintN(bits, value);
    for (let index = 0; index < size; index++) {
      const place = little ? at + index : at + size - 1 - index;
      this.bytes[place] = Number(rest & BigInt(base - 1));
      rest >>= shift;
    }
  }

  f32(value: unknown, little: boolean, step: Step): void {
    this.real32(value, little, step);
    const at = this.room(4);
    for (let index = 0; index < 4; index++) this.bytes[at + index] = WORD_BYTES[index]!;
  }

  f64(value: unknown, little: boolean, step: Step): void {
    this.real64(value, little, step);
    const at = this.room(8);
    for (let index = 0; index < 8; index++) this.bytes[at + index] = WORD_BYTES[index]!;
  }

  /** A float in bytes of 7 bits. */
  float7(value: unknown, bits: 32 | 64, little: boolean, step: Step): void {
    if (bits === 32) this.real32(value, false, step);
    else this.real64(value, false, step);
    const plain = bits === 32 ? BigInt(WORD.getUint32(0)) : WORD.getBigUint64(0);
    this.ubig(plain, Math.ceil(bits / 7), bits, little, 128);
  }

  // A NaN is written in one way.

  private real32(value: unknown, little: boolean, step: Step): void {
    const real = this.real(value, 32, step);
    if (real === real) WORD.setFloat32(0, real, little);
    else WORD.setUint32(0, 0x7fc00000, little);
  }

  private real64(value: unknown, little: boolean, step: Step): void {
    const real = this.real(value, 64, step);
    if (real === real) WORD.setFloat64(0, real, little);
    else WORD.setBigUint64(0, 0x7ff8000000000000n, little);
  }

  // --- bytes and texts -----------------------------------------------------------------------

  /** `least` to `greatest` bytes. */
  octets(
    value: unknown,
    least: number,
    greatest: number,
    sevenBit: boolean,
    step: Step,
    until = -1,
  ): void {
    if (!(value instanceof Uint8Array)) {
      throw this.error(step, `must be a Uint8Array, not ${shown(value)}`);
    }
    this.count(value.length, least, greatest, "bytes", step);
    const at = this.room(value.length);
    this.bytes.set(value, at);
    this.ended(at, sevenBit, until, step);
  }

  /** End bytes from a place on, which have to be such that `until` is their end, if they have one. */
  private ended(from: number, sevenBit: boolean, until: number, step: Step): void {
    const bytes = sevenBit || until >= 0 ? this.bytes.subarray(from, this.size) : NO_BYTES;
    if (until >= 0 && bytes.includes(until)) {
      throw this.error(step, `has ${spelled([until])}, which would end it`);
    }
    const high = sevenBit ? bytes.find((byte) => byte > 0x7f) : undefined;
    if (high !== undefined) {
      throw this.error(step, `${spelled([high])} has its most significant bit set`);
    }
    if (until >= 0) this.byte(until);
  }

  /** The characters of a text, which are bytes. */
  characters(value: unknown, step: Step): string {
    if (typeof value !== "string") throw this.error(step, `must be text, not ${shown(value)}`);
    for (let index = 0; index < value.length; index++) {
      if (value.charCodeAt(index) > (this.strict ? 0x7f : 0xff)) {
        const character = String.fromCodePoint(value.codePointAt(index)!);
        const most = this.strict ? "ASCII, characters up to U+007F" : "characters up to U+00FF";
        throw this.error(step, `must be ${most}; "${character}" is none`);
      }
    }
    return value;
  }

  /** A text of `least` to `greatest` characters. */
  latin1(
    value: unknown,
    least: number,
    greatest: number,
    sevenBit: boolean,
    step: Step,
    until = -1,
  ): void {
    const text = this.characters(value, step);
    this.count(text.length, least, greatest, "characters", step);
    const at = this.room(text.length);
    for (let index = 0; index < text.length; index++) this.bytes[at + index] = text.charCodeAt(index);
    this.ended(at, sevenBit, until, step);
  }

  /** A text among separators. */
  between(
    value: unknown,
    separator: number,
    leads: boolean,
    allowed: string,
    least: number,
    greatest: number,
    step: Step,
  ): void {
    const text = this.characters(value, step);
    this.count(text.length, least, greatest, "characters", step);
    const wrong = [...text].find((character) => !allowed.includes(character));
    if (wrong !== undefined) {
      throw this.error(step, `has "${wrong}", which can't stand between separators here`);
    }
    if (leads) this.byte(separator);
    for (let index = 0; index < text.length; index++) this.byte(text.charCodeAt(index));
  }

  /** A text of a fixed size, which its padding fills up. */
  text(value: unknown, size: number, form: TextForm, sevenBit: boolean, step: Step): void {
    const text = this.characters(value, step);
    let last = text.length;
    while (last && text.charCodeAt(last - 1) === form.padding) last--;
    if (this.strict && last < text.length) {
      throw this.error(step, "ends with what a receiver takes for padding");
    }
    this.count(text.length, 0, size, "characters", step);
    for (let index = 0; index < size; index++) {
      const character = index < last ? text.charCodeAt(index) : form.padding;
      if (character >= 1 << form.bits || (form.padding && !character)) {
        throw this.error(step, `"${text[index]}" is no character of this text`);
      }
      const byte = (character << form.shift) + form.add;
      if (sevenBit && byte > 0x7f) {
        throw this.error(step, `${spelled([byte])} has its most significant bit set`);
      }
      this.byte(byte);
    }
  }

  /** Begin a region of so many bytes; what ends it is given to `close`. */
  open(size: number, _step: Step): readonly [number, number] {
    return [this.size, size];
  }

  /** Refuse a region that has another size than it has to have. */
  close([start, size]: readonly [number, number], step: Step): void {
    if (this.size - start !== size) {
      throw this.error(step, `needs exactly ${size} bytes, not ${this.size - start}`);
    }
  }
}
