/** Integers that are written as text in payloads. */

import type { Reader, Step } from "./reader.js";
import type { Writer } from "./writer.js";

/** Form of an integer of as many digits as it needs, or of one character. */
export interface Numeral {
  readonly base: 10 | 16 | 256;
  readonly padded: number;
  readonly fraction: number;
  readonly signed: boolean;
  readonly upper: boolean;
  /** Greatest integer that so many digits stand for. */
  readonly greatest: number | bigint;
  /** Bytes of the longest text. */
  readonly longest: number;
  /** What no text stands for, where there may be none. */
  readonly absent: number | bigint;
  readonly separator?: number;
  readonly leads?: boolean;
  readonly empty?: boolean;
}

/** Form of an integer of `bits` bits as so many digits out of an alphabet. */
export interface Digits {
  readonly alphabet: string;
  readonly size: number;
  readonly bits: number;
  readonly signed: boolean;
}

/** Read an integer of so many digits. */
export function readDigits(reader: Reader, form: Digits, step: Step): number {
  return Number(readBigDigits(reader, form, step));
}

/** The same of more than 53 bits. */
export function readBigDigits(reader: Reader, form: Digits, step: Step): bigint {
  const { alphabet, size, bits, signed } = form;
  const at = reader.take(size, step);
  let raw = 0n;
  for (let index = at; index < at + size; index++) {
    const digit = alphabet.indexOf(String.fromCharCode(reader.bytes[index]!));
    if (digit < 0) throw reader.fault(step, "value", "a character is no digit here");
    raw = raw * BigInt(alphabet.length) + BigInt(digit);
  }
  if (raw >> BigInt(bits)) throw reader.fault(step, "value", `${raw} does not fit ${bits} bits`);
  return signed ? BigInt.asIntN(bits, raw) : raw;
}

/** Write an integer as so many digits. */
export function writeDigits(
  writer: Writer,
  value: number | bigint,
  form: Digits,
  step: Step,
): void {
  const { alphabet, size, bits } = form;
  let rest = BigInt.asUintN(bits, BigInt(value));
  const base = BigInt(alphabet.length);
  const at = writer.room(size);
  for (let index = at + size - 1; index >= at; index--) {
    writer.bytes[index] = alphabet.charCodeAt(Number(rest % base));
    rest /= base;
  }
  if (rest) throw writer.error(step, `${value} has more than ${size} digits`);
}

/** Read an integer as text. */
export function readNumeral(reader: Reader, form: Numeral, step: Step): number {
  return Number(readBigNumeral(reader, form, step));
}

/** The same of more than 53 bits. */
export function readBigNumeral(reader: Reader, form: Numeral, step: Step): bigint {
  if (form.separator !== undefined && form.leads) {
    if (!reader.left) throw reader.fault(step, "size", "the separator in front is missing");
    if (reader.bytes[reader.at] !== form.separator) {
      throw reader.fault(step, "value", "the separator in front is another byte");
    }
    reader.at++;
  }
  let end = reader.end;
  if (form.separator !== undefined) {
    const found = reader.bytes.subarray(reader.at, reader.end).indexOf(form.separator);
    if (found >= 0) end = reader.at + found;
  }
  let text = "";
  for (let index = reader.at; index < end; index++) {
    text += String.fromCharCode(reader.bytes[index]!);
  }
  const value = numberIn(reader, form, text, step);
  reader.at = end;
  return value;
}

function numberIn(reader: Reader, form: Numeral, text: string, step: Step): bigint {
  const mayBeEmpty = form.separator !== undefined && form.empty;
  if (!text && mayBeEmpty) return BigInt(form.absent);
  if (text.length < 1 || text.length > form.longest) {
    const problem = `needs 1 to ${form.longest} characters, not ${text.length}`;
    throw reader.fault(step, "size", problem);
  }
  if (form.base === 256) {
    const code = text.charCodeAt(0);
    if (mayBeEmpty && code === form.absent) {
      throw reader.fault(step, "value", "this character stands for none");
    }
    return BigInt(code);
  }
  const hasSign = form.signed && (text[0] === "+" || text[0] === "-");
  const digits = hasSign ? text.slice(1) : text;
  const point = form.fraction ? digits.indexOf(".") : -1;
  const front = point < 0 ? digits : digits.slice(0, point);
  const behind = point < 0 ? "" : digits.slice(point + 1);
  const own = behind.slice(0, form.fraction);
  const allowed = form.base === 10 ? /^[0-9]+$/ : /^[0-9A-Fa-f]+$/;
  if (!allowed.test(front + own) || /[^0]/.test(behind.slice(form.fraction))) {
    throw reader.fault(step, "value", `${JSON.stringify(text)} is no number here`);
  }
  const plain = front + own.padEnd(form.fraction, "0");
  const value = BigInt(form.base === 16 ? `0x${plain}` : plain);
  if (value > form.greatest) {
    throw reader.fault(step, "value", `${JSON.stringify(text)} has too many digits`);
  }
  return text[0] === "-" && hasSign ? -value : value;
}

/** Write an integer as text. */
export function writeNumeral(
  writer: Writer,
  value: number | bigint,
  form: Numeral,
  step: Step,
): void {
  if (form.separator !== undefined && form.leads) writer.byte(form.separator);
  if (form.separator !== undefined && form.empty && value === form.absent) return;
  const least = form.signed ? -BigInt(form.greatest) : 0n;
  if (BigInt(value) < least || value > form.greatest) {
    throw writer.error(step, `${value} is not in ${least}..${form.greatest}`);
  }
  if (form.base === 256) {
    writer.byte(Number(value));
    return;
  }
  const plain = BigInt(value) < 0n ? -BigInt(value) : BigInt(value);
  const lower = plain.toString(form.base);
  let digits = form.upper ? lower.toUpperCase() : lower;
  digits = digits.padStart(form.padded + form.fraction, "0");
  if (form.fraction) {
    digits = `${digits.slice(0, -form.fraction)}.${digits.slice(-form.fraction)}`;
  }
  if (BigInt(value) < 0n) digits = `-${digits}`;
  for (let index = 0; index < digits.length; index++) writer.byte(digits.charCodeAt(index));
}
