/** Numbers out of bytes, by the types of the plans. What can't be read throws a ByteError. */
import { hexDigits, pythonBytes } from "./octets.js";

export class ByteError extends Error {}

/** The unsigned integer in bytes of 8 or 7 bits. */
function wholeOf(type, bytes) {
  const ordered = type.isBigEndian || type.role === "ascii" ? bytes : [...bytes].reverse();
  let raw = 0n;
  for (const byte of ordered) {
    if (type.sevenBit && byte > 0x7f) {
      throw new ByteError(`${hexDigits(byte)} has its most significant bit set`);
    }
    raw = (raw << (type.sevenBit ? 7n : 8n)) | BigInt(byte);
  }
  return raw;
}

export const signedOf = (type, raw) => (type.signed ? BigInt.asIntN(type.bits, raw) : raw);

function digitsIn(type, bytes) {
  const { alphabet } = type.text;
  let raw = 0n;
  for (const byte of bytes) {
    const digit = alphabet.indexOf(String.fromCharCode(byte));
    if (digit < 0) throw new ByteError(`${hexDigits(byte)} is no digit here`);
    raw = raw * BigInt(alphabet.length) + BigInt(digit);
  }
  if (raw >> BigInt(type.bits)) throw new ByteError(`${raw} does not fit ${type.bits} bits`);
  return signedOf(type, raw);
}

/** A numeral of any size, with the separator in front where one leads. */
function numeralIn(type, bytes) {
  const form = type.text;
  if (form.separator === undefined) return numeralOf(type, bytes, false);
  let at = 0;
  if (form.leads) {
    if (!bytes.length) throw new ByteError("the separator in front is missing");
    if (bytes[0] !== form.separator) {
      throw new ByteError(`${hexDigits(bytes[0])} is not the separator`);
    }
    at = 1;
  }
  const found = bytes.indexOf(form.separator, at);
  const end = found < 0 ? bytes.length : found;
  const value = numeralOf(type, bytes.slice(at, end), Boolean(form.empty));
  if (end < bytes.length) {
    throw new ByteError(`${pythonBytes(bytes.slice(end))} is left behind the number`);
  }
  return value;
}

function numeralOf(type, bytes, mayBeEmpty) {
  const form = type.text;
  if (!bytes.length && mayBeEmpty) return BigInt(form.absent);
  if (bytes.length < 1 || bytes.length > form.longest) {
    const needed = form.longest === 1 ? "1 character" : `1 to ${form.longest} characters`;
    throw new ByteError(`needs ${needed}, not ${bytes.length}`);
  }
  if (form.base === 256) {
    if (mayBeEmpty && BigInt(bytes[0]) === BigInt(form.absent)) {
      throw new ByteError("this character stands for none");
    }
    return BigInt(bytes[0]);
  }
  const text = String.fromCharCode(...bytes);
  const digits = type.signed && /^[+-]/.test(text) ? text.slice(1) : text;
  const fraction = form.fraction ?? 0;
  const point = fraction ? digits.indexOf(".") : -1;
  const front = point < 0 ? digits : digits.slice(0, point);
  const behind = point < 0 ? "" : digits.slice(point + 1);
  const own = behind.slice(0, fraction);
  const allowed = form.base === 10 ? /^[0-9]+$/ : /^[0-9A-Fa-f]+$/;
  if (!allowed.test(front + own) || /[^0]/.test(behind.slice(fraction))) {
    throw new ByteError(`${pythonBytes(bytes)} is no number here`);
  }
  const plain = front + own.padEnd(fraction, "0");
  const value = BigInt(form.base === 16 ? `0x${plain}` : plain);
  if (value > BigInt(form.greatest)) throw new ByteError(`${pythonBytes(bytes)} has too many digits`);
  return text[0] === "-" ? -value : value;
}

/** The integer in the bytes of a value; of a float the integer of its bits. */
export function decoded(type, bytes) {
  if (type.text) return type.text.alphabet ? digitsIn(type, bytes) : numeralIn(type, bytes);
  const whole = wholeOf(type, bytes);
  if (type.low !== undefined) return (whole >> BigInt(type.low)) & ((1n << BigInt(type.bits)) - 1n);
  if (whole >> BigInt(type.bits)) {
    throw new ByteError(`the bits above the lowest ${type.bits} have to be zero`);
  }
  return signedOf(type, whole);
}

/** The bytes of an integer of a part. */
export function encoded(type, value) {
  const base = type.text ? BigInt(type.text.alphabet.length) : type.sevenBit ? 128n : 256n;
  let rest = BigInt.asUintN(type.bits, BigInt(value));
  const found = [];
  for (let at = 0; at < type.size; at++) {
    const digit = Number(rest % base);
    found.push(type.text ? type.text.alphabet.charCodeAt(digit) : digit);
    rest /= base;
  }
  const isBig = type.text || type.isBigEndian || type.role === "ascii";
  return Uint8Array.from(isBig ? found.reverse() : found);
}

/** The float that has these bits. */
export function floatOf(type, pattern) {
  const view = new DataView(new ArrayBuffer(8));
  if (type.bits === 32) {
    view.setUint32(0, Number(pattern));
    return view.getFloat32(0);
  }
  view.setBigUint64(0, pattern);
  return view.getFloat64(0);
}

/** Characters that a number stands for, without the zeros behind them. */
export function charactersOf(type, value) {
  return String.fromCharCode(...encoded(type, value)).replace(/\0+$/, "");
}
