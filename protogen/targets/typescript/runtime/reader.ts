/** Reads the values of a payload, one after another. Generated functions call it. */

import { equal } from "./bytes.js";
import { Fault, joined, spelled } from "./errors.js";
import type { Value } from "./numbers.js";
import { NO_PARTS, ownOf, type HeldParts } from "./plan.js";

/** Name of a field, or index of an element. */
export type Step = string | number;

/** What ends an array that takes what is left, in bytes or in fields. */
export interface Tail {
  readonly element: number;
  readonly least: number;
  /** The byte in front of each field, where fields are counted. */
  readonly separator?: number;
}

/** Form of a text of a fixed size: its padding, and how its characters lie in bytes. */
export interface TextForm {
  readonly padding: number;
  readonly bits: number;
  readonly shift: number;
  readonly add: number;
}

/** Form of a text whose bytes are its characters, with NUL as padding. */
export const PLAIN_TEXT: TextForm = { padding: 0, bits: 8, shift: 0, add: 0 };

const WORD = new DataView(new ArrayBuffer(8));

/**
 * A place in a payload. Each method takes what is there, or throws a Fault with the path.
 *
 * The last argument of most methods is the name of the field or the index of the element.
 */
export class Reader {
  /** The place of the next byte. */
  at = 0;
  /** The place behind the last byte of the payload, or of the region. */
  end: number;
  private readonly path: Step[] = [];
  private depth = 0;
  private regions = 0;

  /** `held` has the parts of the frame that are fields. */
  constructor(
    public bytes: Uint8Array,
    private held: HeldParts = NO_PARTS,
  ) {
    this.end = bytes.length;
  }

  /** Begin at another payload. */
  restart(bytes: Uint8Array, at: number, end: number, held: HeldParts = NO_PARTS): this {
    this.bytes = bytes;
    this.held = held;
    this.at = at;
    this.end = end;
    this.regions = 0;
    this.depth = 0;
    return this;
  }

  /** The Fault of a field. */
  fault(step: Step, reason: "size" | "value" | "encoding", problem: string, missing = 0): Fault {
    // More bytes behind a region would not help.
    const more = this.regions ? 0 : missing;
    const path = joined([...this.path.slice(0, this.depth), step]);
    return new Fault(reason, problem, path, this.at, more);
  }

  /** Begin what lies inside of a field or an element. */
  enter(step: Step): void {
    this.path[this.depth++] = step;
  }

  /** End what lies inside of it. */
  leave(): void {
    this.depth--;
  }

  /** Bytes that are left. */
  get left(): number {
    return this.end - this.at;
  }

  /** The place of so many bytes, which are taken. */
  take(size: number, step: Step): number {
    const at = this.at;
    if (at + size > this.end) throw this.short(size, step);
    this.at = at + size;
    return at;
  }

  private short(size: number, step: Step): Fault {
    const problem = `needs ${size} bytes, but only ${this.left} are left`;
    return this.fault(step, "size", problem, size - this.left);
  }

  // --- parts of the frame --------------------------------------------------------------------

  /** A number of up to 53 bits that the frame has. */
  part(name: string, step: Step): number {
    return this.heldPart(name, step) as number;
  }

  /** A number of more bits that the frame has. */
  bigPart(name: string, step: Step): bigint {
    return this.heldPart(name, step) as bigint;
  }

  private heldPart(name: string, step: Step): Value {
    const value = ownOf(this.held, name);
    if (value === undefined) throw this.fault(step, "value", `is ${name} of the frame: give it`);
    return value;
  }

  // --- integers ------------------------------------------------------------------------------

  u8(step: Step): number {
    return this.bytes[this.take(1, step)]!;
  }

  i8(step: Step): number {
    return (this.u8(step) << 24) >> 24;
  }

  u16(step: Step): number {
    const at = this.take(2, step);
    return this.bytes[at]! | (this.bytes[at + 1]! << 8);
  }

  u16be(step: Step): number {
    const at = this.take(2, step);
    return (this.bytes[at]! << 8) | this.bytes[at + 1]!;
  }

  i16(step: Step): number {
    return (this.u16(step) << 16) >> 16;
  }

  i16be(step: Step): number {
    return (this.u16be(step) << 16) >> 16;
  }

  i32(step: Step): number {
    const at = this.take(4, step);
    const b = this.bytes;
    return b[at]! | (b[at + 1]! << 8) | (b[at + 2]! << 16) | (b[at + 3]! << 24);
  }

  i32be(step: Step): number {
    const at = this.take(4, step);
    const b = this.bytes;
    return (b[at]! << 24) | (b[at + 1]! << 16) | (b[at + 2]! << 8) | b[at + 3]!;
  }

  u32(step: Step): number {
    return this.i32(step) >>> 0;
  }

  u32be(step: Step): number {
    return this.i32be(step) >>> 0;
  }

  u64(step: Step): bigint {
    const low = this.u32(step);
    return (BigInt(this.u32(step)) << 32n) | BigInt(low);
  }

  u64be(step: Step): bigint {
    const high = this.u32be(step);
    return (BigInt(high) << 32n) | BigInt(this.u32be(step));
  }

  i64(step: Step): bigint {
    return BigInt.asIntN(64, this.u64(step));
  }

  i64be(step: Step): bigint {
    return BigInt.asIntN(64, this.u64be(step));
  }

  /** An unsigned integer of 7 bits. */
  u7(step: Step): number {
    const found = this.u8(step);
    if (found > 0x7f) throw this.eighthBit(found, step);
    return found;
  }

  /** One of 14 bits, 7 in each byte, the least significant ones first. */
  u14(step: Step): number {
    const at = this.take(2, step);
    const low = this.bytes[at]!;
    const high = this.bytes[at + 1]!;
    if ((low | high) > 0x7f) throw this.eighthBit(high > 0x7f ? high : low, step);
    return low | (high << 7);
  }

  i14(step: Step): number {
    return (this.u14(step) << 18) >> 18;
  }

  /** An unsigned integer of up to 53 bits in bytes of 8 bits or, if `base` is 128, of 7. */
  uint(size: number, bits: number, little: boolean, base: 128 | 256, step: Step): number {
    const start = this.take(size, step);
    const { bytes } = this;
    const first = little ? start + size - 1 : start;
    let raw = bytes[first]!;
    if (raw >= base) throw this.eighthBit(raw, step);
    for (let index = 1; index < size; index++) {
      const byte = bytes[little ? first - index : first + index]!;
      if (byte >= base) throw this.eighthBit(byte, step);
      raw = raw * base + byte;
    }
    if (raw >= 2 ** bits) throw this.padding(bits, step);
    return raw;
  }

  /** A signed integer of up to 53 bits; two's complement in its bits. */
  sint(size: number, bits: number, little: boolean, base: 128 | 256, step: Step): number {
    const raw = this.uint(size, bits, little, base, step);
    return raw >= 2 ** (bits - 1) ? raw - 2 ** bits : raw;
  }

  /** An unsigned integer of more than 53 bits. */
  ubig(size: number, bits: number, little: boolean, base: 128 | 256, step: Step): bigint {
    const start = this.take(size, step);
    const shift = base === 128 ? 7n : 8n;
    let raw = 0n;
    for (let index = 0; index < size; index++) {
      const byte = this.bytes[little ? start + size - 1 - index : start + index]!;
      if (byte >= base) throw this.eighthBit(byte, step);
      raw = (raw << shift) | BigInt(byte);
    }
    if (raw >> BigInt(bits)) throw this.padding(bits, step);
    return raw;
  }

  /** A signed integer of more than 53 bits. */
  sbig(size: number, bits: number, little: boolean, base: 128 | 256, step: Step): bigint {
    return BigInt.asIntN(bits, this.ubig(size, bits, little, base, step));
  }

  private eighthBit(byte: number, step: Step): Fault {
    return this.fault(step, "encoding", `${spelled([byte])} has its most significant bit set`);
  }

  private padding(bits: number, step: Step): Fault {
    return this.fault(step, "value", `the bits above the lowest ${bits} have to be zero`);
  }

  bool(step: Step): boolean {
    const byte = this.u8(step);
    if (byte > 1) {
      throw this.fault(step, "value", `${spelled([byte])} is neither 00 (false) nor 01 (true)`);
    }
    return byte === 1;
  }

  // --- floats --------------------------------------------------------------------------------

  f32(little: boolean, step: Step): number {
    WORD.setUint32(0, little ? this.u32(step) : this.u32be(step));
    return WORD.getFloat32(0);
  }

  f64(little: boolean, step: Step): number {
    const at = this.take(8, step);
    for (let index = 0; index < 8; index++) {
      WORD.setUint8(little ? 7 - index : index, this.bytes[at + index]!);
    }
    return WORD.getFloat64(0);
  }

  /** A float in bytes of 7 bits. */
  float7(bits: 32 | 64, little: boolean, step: Step): number {
    const raw = this.ubig(Math.ceil(bits / 7), bits, little, 128, step);
    WORD.setBigUint64(0, raw << BigInt(64 - bits));
    return bits === 32 ? WORD.getFloat32(0) : WORD.getFloat64(0);
  }

  // --- values that are checked ---------------------------------------------------------------

  /** A value out of a closed enum. */
  one<T extends number | bigint>(value: number | bigint, values: readonly T[], step: Step): T {
    if (!values.includes(value as T)) {
      throw this.fault(step, "value", `${value} is not one of ${values.join(", ")}`);
    }
    return value as T;
  }

  /** A constant. */
  constant<const T>(value: unknown, due: T, step: Step): T {
    if (!same(value, due)) throw this.fault(step, "value", `must be ${shown(due)}`);
    return due;
  }

  /** A number that earlier fields give, of elements or bytes. */
  count(number: number, least: number, greatest: number, by: string, step: Step): number {
    if (number < least || number > greatest) {
      throw this.fault(step, "size", `${by} counts ${least} to ${greatest}, not ${number}`);
    }
    return number;
  }

  /** The Fault of a selector without a case. */
  noCase(value: number | bigint, by: string, step: Step): Fault {
    return this.fault(step, "value", `there is no case for ${by} = ${value}`);
  }

  // --- bytes and texts -----------------------------------------------------------------------

  /** So many bytes, which are copied; with `sevenBit` each is at most 7F. */
  octets(size: number, sevenBit: boolean, step: Step): Uint8Array {
    const at = this.take(size, step);
    const found = this.bytes.slice(at, at + size);
    if (sevenBit) for (const byte of found) if (byte > 0x7f) throw this.eighthBit(byte, step);
    return found;
  }

  /** So many bytes as a text, one character each. */
  latin1(size: number, sevenBit: boolean, step: Step): string {
    const at = this.take(size, step);
    const { bytes } = this;
    let text = "";
    for (let place = at; place < at + size; place++) {
      const byte = bytes[place]!;
      if (sevenBit && byte > 0x7f) throw this.eighthBit(byte, step);
      text += String.fromCharCode(byte);
    }
    return text;
  }

  /** The number of bytes that are left. */
  rest(least: number, greatest: number, step: Step): number {
    const size = this.left;
    if (size < least || size > greatest) {
      throw this.fault(step, "size", `has ${size} bytes, and not ${least} to ${greatest}`);
    }
    return size;
  }

  /** Bytes in front of a terminator, which is taken, too. */
  until(byte: number, least: number, greatest: number, sevenBit: boolean, step: Step): Uint8Array {
    const most = Math.min(this.left, greatest + 1);
    const found = this.bytes.subarray(this.at, this.at + most).indexOf(byte);
    if (most <= least || (found < 0 && most <= greatest)) {
      const missing = Math.max(1, least + 1 - most);
      throw this.fault(step, "size", `ends with ${spelled([byte])}, which is missing`, missing);
    }
    const size = found < 0 ? most : found;
    if (size < least || size > greatest) {
      throw this.fault(step, "size", `has ${size} bytes, and not ${least} to ${greatest}`);
    }
    const data = this.octets(size, sevenBit, step);
    this.at++;
    return data;
  }

  /** A text in front of a separator or of the end; with `leads` a separator stands in front. */
  between(
    separator: number,
    leads: boolean,
    allowed: string,
    least: number,
    greatest: number,
    step: Step,
  ): string {
    if (leads) this.separator(separator, step);
    const takesRest = allowed.includes(String.fromCharCode(separator));
    const found = takesRest ? -1 : this.bytes.subarray(this.at, this.end).indexOf(separator);
    const size = found < 0 ? this.left : found;
    if (size < least || size > greatest) {
      throw this.fault(step, "size", `needs ${least} to ${greatest} characters, not ${size}`);
    }
    for (let index = this.at; index < this.at + size; index++) {
      if (!allowed.includes(String.fromCharCode(this.bytes[index]!))) {
        const wrong = spelled([this.bytes[index]!]);
        throw this.fault(step, "value", `${wrong} is no character of it`);
      }
    }
    return this.latin1(size, false, step);
  }

  private separator(separator: number, step: Step): void {
    if (this.at >= this.end) throw this.fault(step, "size", "the separator in front is missing");
    if (this.bytes[this.at] !== separator) {
      throw this.fault(step, "value", `${spelled([this.bytes[this.at]!])} is not the separator`);
    }
    this.at++;
  }

  /** A text of a fixed size without its padding. */
  text(size: number, form: TextForm, sevenBit: boolean, step: Step): string {
    const data = this.octets(size, sevenBit, step);
    let found = "";
    for (const byte of data) {
      const moved = byte - form.add;
      const character = moved >> form.shift;
      const isOne = moved >= 0 && character << form.shift === moved && character < 1 << form.bits;
      if (!isOne || (form.padding && !character)) {
        throw this.fault(step, "value", `${spelled([byte])} is no character of this text`);
      }
      found += String.fromCharCode(character);
    }
    let last = found.length;
    while (last && found.charCodeAt(last - 1) === form.padding) last--;
    return found.slice(0, last);
  }

  // --- regions, elements, bits ---------------------------------------------------------------

  /** Begin a region of so many bytes; what ends it is given to `close`. */
  open(size: number, step: Step): number {
    if (this.at + size > this.end) throw this.short(size, step);
    const outer = this.end;
    this.regions++;
    this.end = this.at + size;
    return outer;
  }

  /** End a region, of which nothing may be left. */
  close(outer: number, step: Step): void {
    if (this.left) throw this.fault(step, "size", `${this.left} bytes are left over`);
    this.regions--;
    this.end = outer;
  }

  /** The place of another element that takes what is left, -1 at its end; `here`: the one before. */
  next(here: number, index: number, least: number, greatest: number): number {
    if (this.at === here) {
      throw this.fault("", "size", "an element of no bytes fills nothing");
    }
    if (this.left > 0) {
      this.count(index + 1, 0, greatest, "fill", "");
      return this.at;
    }
    this.count(index, least, greatest, "fill", "");
    return -1;
  }

  /** True if another element stands behind one that is not the last. */
  goesOn(isLast: boolean, index: number, least: number, greatest: number): boolean {
    if (isLast) this.count(index, least, greatest, "fill", "");
    else this.count(index + 1, 0, greatest, "fill", "");
    return !isLast;
  }

  /** The number of elements in front of a tail. */
  elements(tail: Tail): number {
    let left = this.left;
    if (tail.separator !== undefined) {
      left = 0;
      for (let index = this.at; index < this.end; index++) {
        if (this.bytes[index] === tail.separator) left++;
      }
    }
    return Math.floor(Math.max(0, left - tail.least) / tail.element);
  }

  /** Take a run of packed bits as one integer. */
  run(size: number, little: boolean, step: Step): bigint {
    return this.ubig(size, 8 * size, little, 256, step);
  }

  /** Refuse bits of a run that belong to no number. */
  unused(run: bigint, mask: bigint, step: Step): void {
    if (run & mask) throw this.fault(step, "value", "the bits behind the last one have to be zero");
  }

  /** Refuse what is left of the payload. */
  finish(): void {
    if (this.left) throw this.fault("", "size", `${this.left} bytes too many`);
  }
}

/** The text of some bytes, one character each. */
export function latin1(bytes: Uint8Array): string {
  let text = "";
  for (const byte of bytes) text += String.fromCharCode(byte);
  return text;
}

/** True if two values of constants are equal. */
export function same(one: unknown, other: unknown): boolean {
  if (one instanceof Uint8Array && other instanceof Uint8Array) return equal(one, other);
  if (Array.isArray(one) && Array.isArray(other)) {
    return one.length === other.length && one.every((item, index) => same(item, other[index]));
  }
  return one === other;
}

/** A value as errors show it. */
export function shown(value: unknown): string {
  if (value instanceof Uint8Array) return spelled(value);
  if (Array.isArray(value)) return `[${value.map(shown).join(", ")}]`;
  return typeof value === "string" ? JSON.stringify(value) : String(value);
}
