/** Writes the values of a payload, one after another. Generated functions call it. */

import { firstOf, NO_BYTES } from "./bytes.js";
import { Checks } from "./checks.js";
import { spelled } from "./errors.js";
import type { Value } from "./numbers.js";
import { NO_PARTS, type HeldParts } from "./plan.js";
import { shown, type Step, type TextForm } from "./reader.js";

const WORD_BYTES = new Uint8Array(8);
const WORD = new DataView(WORD_BYTES.buffer);

/** How many values a byte has. */
type Base = 128 | 256;

/** The greatest unsigned integer of so many bits. */
function greatestOf(bits: number): number {
  return bits < 31 ? (1 << bits) - 1 : 2 ** bits - 1;
}

/**
 * Bytes of a payload so far. Each method appends a value, or throws an EncodeError.
 *
 * There may be room in front of the payload, for the parts of the frame that stand there.
 */
export class Writer extends Checks {
  /** What is written into where nobody knows how much it will be. */
  private scratch: Uint8Array = new Uint8Array(256);
  bytes: Uint8Array = this.scratch;
  /** A frame as it is on the wire. */
  private stuffed: Uint8Array = new Uint8Array(256);
  /** Bytes so far, those in front of the payload among them. */
  size = 0;
  /** Values of the fields that are parts of the frame, by the names of the parts. */
  held: HeldParts = NO_PARTS;

  /**
   * Begin another payload behind so many bytes.
   *
   * With a size, all that will be written has so many bytes.
   */
  restart(strict: boolean, from: number, size: number): this {
    this.strict = strict;
    this.bytes = size ? new Uint8Array(size) : this.scratch;
    this.size = from;
    if (from > this.bytes.length) this.grow();
    this.held = NO_PARTS;
    if (this.path.length) this.path.length = 0;
    return this;
  }

  /** All that was written. */
  taken(): Uint8Array {
    return this.bytes === this.scratch ? firstOf(this.bytes, this.size) : this.bytes;
  }

  /** The place of so many more bytes. */
  room(size: number): number {
    const at = this.size;
    this.size = at + size;
    if (this.size > this.bytes.length) this.grow();
    return at;
  }

  /** Room for so many bytes of a frame as it is on the wire. */
  wire(size: number): Uint8Array {
    if (size > this.stuffed.length) this.stuffed = new Uint8Array(2 * size);
    return this.stuffed;
  }

  private grow(): void {
    const larger = new Uint8Array(Math.max(2 * this.bytes.length, this.size));
    larger.set(this.bytes);
    this.bytes = this.scratch = larger;
  }

  /** Leave a number to the frame, whose part it is. */
  part(name: string, value: Value): void {
    this.held = { ...this.held, [name]: value };
  }

  // --- integers ------------------------------------------------------------------------------

  // An encoder spends most of its time here, so each of them calls no other.

  u8(value: unknown, step: Step): void {
    if (typeof value !== "number" || value !== (value & 0xff)) {
      throw this.noInteger(value, 0, 0xff, step);
    }
    const at = this.size;
    this.size = at + 1;
    if (this.size > this.bytes.length) this.grow();
    const { bytes } = this;
    bytes[at] = value;
  }

  i8(value: unknown, step: Step): void {
    if (typeof value !== "number" || value !== (value << 24) >> 24) {
      throw this.noInteger(value, -0x80, 0x7f, step);
    }
    const at = this.size;
    this.size = at + 1;
    if (this.size > this.bytes.length) this.grow();
    const { bytes } = this;
    bytes[at] = value;
  }

  u16(value: unknown, step: Step): void {
    if (typeof value !== "number" || value !== (value & 0xffff)) {
      throw this.noInteger(value, 0, 0xffff, step);
    }
    const at = this.size;
    this.size = at + 2;
    if (this.size > this.bytes.length) this.grow();
    const { bytes } = this;
    bytes[at] = value;
    bytes[at + 1] = value >> 8;
  }

  i16(value: unknown, step: Step): void {
    if (typeof value !== "number" || value !== (value << 16) >> 16) {
      throw this.noInteger(value, -0x8000, 0x7fff, step);
    }
    const at = this.size;
    this.size = at + 2;
    if (this.size > this.bytes.length) this.grow();
    const { bytes } = this;
    bytes[at] = value;
    bytes[at + 1] = value >> 8;
  }

  u16be(value: unknown, step: Step): void {
    if (typeof value !== "number" || value !== (value & 0xffff)) {
      throw this.noInteger(value, 0, 0xffff, step);
    }
    const at = this.size;
    this.size = at + 2;
    if (this.size > this.bytes.length) this.grow();
    const { bytes } = this;
    bytes[at] = value >> 8;
    bytes[at + 1] = value;
  }

  i16be(value: unknown, step: Step): void {
    if (typeof value !== "number" || value !== (value << 16) >> 16) {
      throw this.noInteger(value, -0x8000, 0x7fff, step);
    }
    const at = this.size;
    this.size = at + 2;
    if (this.size > this.bytes.length) this.grow();
    const { bytes } = this;
    bytes[at] = value >> 8;
    bytes[at + 1] = value;
  }

  /** All bits of a byte of 7 bits. */
  u7(value: unknown, step: Step): void {
    if (typeof value !== "number" || value !== (value & 0x7f)) {
      throw this.noInteger(value, 0, 0x7f, step);
    }
    const at = this.size;
    this.size = at + 1;
    if (this.size > this.bytes.length) this.grow();
    const { bytes } = this;
    bytes[at] = value;
  }

  /** All bits of two bytes of 7 bits, the least significant byte first. */
  u14(value: unknown, step: Step): void {
    if (typeof value !== "number" || value !== (value & 0x3fff)) {
      throw this.noInteger(value, 0, 0x3fff, step);
    }
    const at = this.size;
    this.size = at + 2;
    if (this.size > this.bytes.length) this.grow();
    const { bytes } = this;
    bytes[at] = value & 0x7f;
    bytes[at + 1] = value >> 7;
  }

  /** The same of a signed one. */
  i14(value: unknown, step: Step): void {
    if (typeof value !== "number" || value !== (value << 18) >> 18) {
      throw this.noInteger(value, -0x2000, 0x1fff, step);
    }
    const at = this.size;
    this.size = at + 2;
    if (this.size > this.bytes.length) this.grow();
    const { bytes } = this;
    bytes[at] = value & 0x7f;
    bytes[at + 1] = (value >> 7) & 0x7f;
  }

  u32(value: unknown, step: Step): void {
    if (typeof value !== "number" || value !== value >>> 0) {
      throw this.noInteger(value, 0, 0xffffffff, step);
    }
    const at = this.size;
    this.size = at + 4;
    if (this.size > this.bytes.length) this.grow();
    const { bytes } = this;
    bytes[at] = value;
    bytes[at + 1] = value >> 8;
    bytes[at + 2] = value >> 16;
    bytes[at + 3] = value >> 24;
  }

  i32(value: unknown, step: Step): void {
    if (typeof value !== "number" || value !== (value | 0)) {
      throw this.noInteger(value, -0x80000000, 0x7fffffff, step);
    }
    const at = this.size;
    this.size = at + 4;
    if (this.size > this.bytes.length) this.grow();
    const { bytes } = this;
    bytes[at] = value;
    bytes[at + 1] = value >> 8;
    bytes[at + 2] = value >> 16;
    bytes[at + 3] = value >> 24;
  }

  u32be(value: unknown, step: Step): void {
    if (typeof value !== "number" || value !== value >>> 0) {
      throw this.noInteger(value, 0, 0xffffffff, step);
    }
    const at = this.size;
    this.size = at + 4;
    if (this.size > this.bytes.length) this.grow();
    const { bytes } = this;
    bytes[at] = value >> 24;
    bytes[at + 1] = value >> 16;
    bytes[at + 2] = value >> 8;
    bytes[at + 3] = value;
  }

  i32be(value: unknown, step: Step): void {
    if (typeof value !== "number" || value !== (value | 0)) {
      throw this.noInteger(value, -0x80000000, 0x7fffffff, step);
    }
    const at = this.size;
    this.size = at + 4;
    if (this.size > this.bytes.length) this.grow();
    const { bytes } = this;
    bytes[at] = value >> 24;
    bytes[at + 1] = value >> 16;
    bytes[at + 2] = value >> 8;
    bytes[at + 3] = value;
  }

  /** The lowest eight bits. */
  byte(value: number): void {
    const at = this.room(1);
    this.bytes[at] = value;
  }

  /** A truth value as a byte. */
  bool(value: unknown, step: Step): void {
    this.byte(this.truth(value, step));
  }

  /** An unsigned integer in bytes of 8 bits or, if `base` is 128, of 7. */
  uint(value: unknown, size: number, bits: number, little: boolean, base: Base, step: Step): void {
    const most = greatestOf(bits);
    const isIn = typeof value === "number" && value >= 0 && value <= most;
    if (isIn && Number.isInteger(value)) this.lowest(value, size, bits, little, base);
    else throw this.noInteger(value, 0, most, step);
  }

  /** The same of a signed one. */
  sint(value: unknown, size: number, bits: number, little: boolean, base: Base, step: Step): void {
    const most = greatestOf(bits - 1);
    const isIn = typeof value === "number" && value >= -most - 1 && value <= most;
    if (isIn && Number.isInteger(value)) this.lowest(value, size, bits, little, base);
    else throw this.noInteger(value, -most - 1, most, step);
  }

  /** The lowest bits of an integer. */
  private lowest(value: number, size: number, bits: number, little: boolean, base: Base): void {
    const first = this.size;
    this.size = first + size;
    if (this.size > this.bytes.length) this.grow();
    const { bytes } = this;
    if (size <= 2 && bits < 32) {
      const lowest = value & greatestOf(bits);
      bytes[little ? first : first + size - 1] = lowest & (base - 1);
      if (size === 2) bytes[little ? first + 1 : first] = base === 128 ? lowest >> 7 : lowest >> 8;
      return;
    }
    const next = little ? 1 : -1;
    let at = little ? first : first + size - 1;
    if (bits < 32) {
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

  /** End the bytes from a place on by `until`, if they have an end, and refuse what they can't be. */
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
    const text = typeof value === "string" ? value : this.characters(value, step);
    const size = text.length;
    const at = this.size;
    if (size >= least && size <= greatest) this.room(size);
    const { bytes } = this;
    let bits = 0;
    for (let index = 0; index < size; index++) {
      const character = text.charCodeAt(index);
      bits |= character;
      bytes[at + index] = character;
    }
    // Only a text with a wrong character is looked at again.
    if (bits > (this.strict ? 0x7f : 0xff)) this.characters(text, step);
    this.count(size, least, greatest, "characters", step);
    if (sevenBit || until >= 0) this.ended(at, sevenBit, until, step);
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
