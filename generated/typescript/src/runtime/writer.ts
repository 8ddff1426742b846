/** Writes the values of a payload, one after another. Generated functions call it. */

import { EncodeError, joined, spelled } from "./errors.js";
import type { Value } from "./numbers.js";
import { same, shown, type Step, type TextForm } from "./reader.js";

const WORD = new DataView(new ArrayBuffer(8));
const GREATEST_FLOAT32 = (2 - 2 ** -23) * 2 ** 127;

/**
 * Bytes of a payload so far. Each method appends a value, or throws an EncodeError.
 *
 * There may be room in front of the payload, for the parts of the frame that stand there.
 */
export class Writer {
  bytes: Uint8Array = new Uint8Array(256);
  /** Bytes so far, those in front of the payload among them. */
  size = 0;
  /** Values of the fields that are parts of the frame, by the names of the parts. */
  held: Record<string, Value> = {};
  private readonly path: Step[] = [];

  /** With `strict`, values that the schema forbids are refused, even where they fit the wire. */
  constructor(public strict: boolean) {}

  /** Begin another payload, in the place of the one before, behind so many bytes. */
  restart(strict: boolean, from: number): this {
    this.strict = strict;
    this.size = 0;
    this.room(from);
    this.held = {};
    if (this.path.length) this.path.length = 0;
    return this;
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
    if (at + size > this.bytes.length) {
      const larger = new Uint8Array(Math.max(2 * this.bytes.length, at + size));
      larger.set(this.bytes);
      this.bytes = larger;
    }
    this.size = at + size;
    return at;
  }

  /** Leave a number to the frame, whose part it is. */
  part(name: string, value: Value): void {
    this.held[name] = value;
  }

  // --- checks --------------------------------------------------------------------------------

  /** An integer that the wire can hold. */
  int(value: unknown, low: number, high: number, step: Step): number {
    if (typeof value !== "number" || !Number.isInteger(value)) {
      throw this.error(step, `must be an integer, not ${shown(value)}`);
    }
    if (value < low || value > high) throw this.error(step, `${value} is not in ${low}..${high}`);
    return value;
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
    if (!this.strict || special.includes(value)) return value;
    // Not-a-number is in no range that has a bound.
    const isIn = (least === null || value >= least) && (greatest === null || value <= greatest);
    if (!isIn) throw this.error(step, `${value} is not in ${least ?? ""}..${greatest ?? ""}`);
    return value;
  }

  /** A value out of a closed enum. */
  one<T extends number | bigint>(value: number | bigint, values: readonly T[], step: Step): T {
    if (!values.includes(value as T)) {
      throw this.error(step, `${value} has no name; there are ${values.join(", ")}`);
    }
    return value as T;
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

  u8(value: number): void {
    const at = this.room(1);
    this.bytes[at] = value;
  }

  u16(value: number): void {
    const at = this.room(2);
    this.bytes[at] = value;
    this.bytes[at + 1] = value >> 8;
  }

  u16be(value: number): void {
    const at = this.room(2);
    this.bytes[at] = value >> 8;
    this.bytes[at + 1] = value;
  }

  u32(value: number): void {
    const at = this.room(4);
    this.bytes[at] = value;
    this.bytes[at + 1] = value >> 8;
    this.bytes[at + 2] = value >> 16;
    this.bytes[at + 3] = value >> 24;
  }

  u32be(value: number): void {
    const at = this.room(4);
    this.bytes[at] = value >> 24;
    this.bytes[at + 1] = value >> 16;
    this.bytes[at + 2] = value >> 8;
    this.bytes[at + 3] = value;
  }

  /** The lowest bits of an integer in bytes of 8 bits or, if `base` is 128, of 7. */
  uint(value: number, size: number, bits: number, little: boolean, base: 128 | 256): void {
    const at = this.room(size);
    if (bits < 32) {
      const shift = base === 128 ? 7 : 8;
      for (let index = 0, left = value & (2 ** bits - 1); index < size; index++) {
        this.bytes[little ? at + index : at + size - 1 - index] = left & (base - 1);
        left >>= shift;
      }
      return;
    }
    let rest = value < 0 ? value + 2 ** bits : value;
    for (let index = 0; index < size; index++) {
      this.bytes[little ? at + index : at + size - 1 - index] = rest % base;
      rest = Math.floor(rest / base);
    }
  }

  /** The same of more than 53 bits. */
  ubig(value: bigint, size: number, bits: number, little: boolean, base: 128 | 256): void {
    const at = this.room(size);
    const shift = base === 128 ? 7n : 8n;
    let rest = BigInt.asUintN(bits, value);
    for (let index = 0; index < size; index++) {
      const place = little ? at + index : at + size - 1 - index;
      this.bytes[place] = Number(rest & BigInt(base - 1));
      rest >>= shift;
    }
  }

  /** A float; `base` is 256, or 128 in bytes of 7 bits. A NaN is written in one way. */
  float(value: number, bits: 32 | 64, little: boolean, base: 128 | 256): void {
    if (bits === 32) WORD.setFloat32(0, value);
    else WORD.setFloat64(0, value);
    const isNan = value !== value;
    const plain = bits === 32 ? BigInt(WORD.getUint32(0)) : WORD.getBigUint64(0);
    const nan = bits === 32 ? 0x7fc00000n : 0x7ff8000000000000n;
    const size = Math.ceil(bits / (base === 128 ? 7 : 8));
    this.ubig(isNan ? nan : plain, size, bits, little, base);
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
    if (until >= 0 && value.includes(until)) {
      throw this.error(step, `has ${spelled([until])}, which would end it`);
    }
    const high = sevenBit ? value.find((byte) => byte > 0x7f) : undefined;
    if (high !== undefined) {
      throw this.error(step, `${spelled([high])} has its most significant bit set`);
    }
    const at = this.room(value.length);
    this.bytes.set(value, at);
    if (until >= 0) this.u8(until);
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
    const data = new Uint8Array(text.length);
    for (let index = 0; index < data.length; index++) data[index] = text.charCodeAt(index);
    this.octets(data, 0, data.length, sevenBit, step, until);
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
    if (leads) this.u8(separator);
    for (let index = 0; index < text.length; index++) this.u8(text.charCodeAt(index));
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
      this.u8(byte);
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
