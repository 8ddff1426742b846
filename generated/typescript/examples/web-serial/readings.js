/** Raw values as people read them. */
import { decimal, fraction, fractionIn, fractionOf, plus, pythonFloat, times } from "./fractions.js";

/** The character of that code in quotes, or the number where it can't be printed. */
export const character = (value) =>
  value >= 0x20n && value < 0x7fn ? `'${String.fromCharCode(Number(value))}'` : String(value);

/** The physical value and, behind a blank, its unit. */
export function physical(field, raw) {
  const unit = field.unit ? ` ${field.unit}` : "";
  const isFloat = typeof raw === "number";
  if (isFloat && (!Number.isFinite(raw) || field.scale === undefined)) {
    return `${pythonFloat(raw)}${unit}`;
  }
  return `${decimal(scaled(field, isFloat ? fractionOf(raw) : fraction(raw)))}${unit}`;
}

export const scaled = (field, raw) =>
  plus(times(raw, fractionIn(field.scale, 1n)), fractionIn(field.offset, 0n));

const nameIn = (values, value) =>
  Object.keys(values ?? {}).find((name) => BigInt(values[name]) === value);

/** The name of a raw value: a special value's, or the enum's. */
export const valueName = (field, type, value, enums) =>
  nameIn(field.special, value) ?? nameIn(enums[type.enum]?.values, value);

const lowestHex = (value) => `0x${value.toString(16)}`;

function flagNames(flags, value) {
  const entries = Object.entries(flags);
  const names = entries.filter(([, bit]) => (value >> BigInt(bit)) & 1n).map(([name]) => name);
  const known = entries.reduce((mask, [, bit]) => mask | (1n << BigInt(bit)), 0n);
  const unnamed = value & ~known;
  return [...names, ...(unnamed ? [lowestHex(unnamed)] : [])].join("|") || "0";
}

function runValues(type, value, enums) {
  let unnamed = BigInt.asUintN(type.bits, value);
  const texts = type.runs.map((run) => {
    const mask = BigInt(run.mask);
    const number = (BigInt.asUintN(type.bits, value) & mask) >> BigInt(run.low);
    unnamed &= ~mask;
    return `${run.name}=${nameIn(enums[run.enum]?.values, number) ?? number}`;
  });
  return `{${[...texts, ...(unnamed ? [lowestHex(unnamed)] : [])].join(", ")}}`;
}

/** The name of an integer, what its bits mean, or its physical value. */
export function integerReading(field, type, value, enums) {
  const name = valueName(field, type, value, enums);
  if (name !== undefined) return name;
  if (type.flags) return flagNames(type.flags, value);
  if (type.runs) return runValues(type, value, enums);
  if (type.role === "bool") return value ? "true" : "false";
  return type.role === "char" ? character(value) : physical(field, value);
}
