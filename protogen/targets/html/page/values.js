/** Values of messages as the codec takes them: what a field has at first, and what people write. */
import { decimalIn, fractionIn, minus, over, rounded } from "./fractions.js";
import { said } from "./expressions.js";
import { hexOf } from "./octets.js";
import { parseHex } from "./tokens.js";

export const keyOf = (step) => step.key ?? step.name;

/** An integer as the codec has it. */
export function asNumber(type, raw) {
  if (type.role === "bool") return raw !== 0n;
  return type.isBig ? raw : Number(raw);
}

export const asBigInt = (value) => (typeof value === "boolean" ? BigInt(Number(value)) : BigInt(value));

const isInteger = (step) => step.type?.kind === "integer";

/** The bounds of an integer of a field. */
export function boundsOf(step) {
  const { type } = step;
  const bits = BigInt(type.bits);
  let least = type.signed ? -(1n << (bits - 1n)) : 0n;
  let greatest = (1n << (type.signed ? bits - 1n : bits)) - 1n;
  const [low, high] = step.range ?? [];
  if (low) least = ceiling(fractionIn(low));
  if (high) greatest = -ceiling(negative(fractionIn(high)));
  return [least, greatest];
}

const negative = ({ n, d }) => ({ n: -n, d });
const ceiling = ({ n, d }) => (n >= 0n ? (n + d - 1n) / d : n / d);

/** The value that a field has at first; undefined where the codec works it out. */
export function firstValue(step, enums, look = () => undefined) {
  if (step.computed) return undefined;
  switch (step.kind) {
    case "constant":
      return constantOf(step.step);
    case "record":
      return firstRecord(step.steps ?? [], enums, look);
    case "repeat":
      return Array.from({ length: firstCount(step.count) }, () => firstValue(step.element, enums, look));
    case "optional":
      return isThere(step, look) ? firstValue(step.step, enums, look) : null;
    case "region":
      return firstValue(step.step, enums, look);
    case "choose":
      return firstCase(chosen(step, look), enums, look);
    default:
      return firstScalar(step, enums);
  }
}

const firstCount = (count) => count.known ?? (count.least || (count.mark === undefined ? 0 : 1));

export const isThere = (step, look) => step.when !== undefined && Boolean(said(step.when, look));

export function firstCase(step, enums, look) {
  if (!step) return new Uint8Array(0);
  return step.kind === "record" && !step.steps?.length ? null : firstValue(step, enums, look);
}

/** The step of the case that earlier values choose; undefined: there is none. */
export function chosen(step, look) {
  const value = said(step.expression, look);
  const cases = step.cases ?? [];
  const fits = cases.find((item) => item.value !== undefined && BigInt(item.value) === value);
  return (fits ?? cases.find((item) => item.isElse))?.step;
}

/** A record; its own values are looked up in front of those around it. */
export function firstRecord(steps, enums, around) {
  const values = {};
  const look = lookIn(values, around);
  for (const step of steps) {
    const value = firstValue(step, enums, look);
    if (value !== undefined) values[keyOf(step)] = value;
  }
  return values;
}

/** What looks a number up in a record, and where it has none around it. */
export function lookIn(values, around = () => undefined) {
  return (name) => {
    const [first, ...others] = name.split(".");
    const member = (holder, own) => holder?.[own] ?? holder?.[`${own}_`];
    let found = member(values, first);
    if (found === undefined) return around(name);
    for (const own of others) found = member(found, own);
    const isNumber = ["number", "bigint", "boolean"].includes(typeof found);
    return isNumber ? asBigInt(found) : undefined;
  };
}

function constantOf(step) {
  const due = step.const;
  if (due === undefined) return undefined;
  if (Array.isArray(due)) return due.map((item) => asNumber(step.element.type, BigInt(item)));
  if (isInteger(step)) return asNumber(step.type, asBigInt(due));
  return due;
}

function firstScalar(step, enums) {
  if (step.default !== undefined) {
    return isInteger(step) ? asNumber(step.type, asBigInt(step.default)) : step.default;
  }
  const { type, count } = step;
  if (type.kind === "float") return Number(step.range?.[0]?.split("/").reduce((a, b) => a / b) ?? 0);
  if (type.kind === "text") return "0".repeat(type.size === undefined ? (count.known ?? count.least ?? 0) : 0);
  if (type.kind === "octets") return new Uint8Array(count.known ?? count.least ?? 0);
  const listed = enums[type.enum];
  const [least, greatest] = boundsOf(step);
  let raw = least > 0n ? least : greatest < 0n ? greatest : 0n;
  if (listed?.closed && !Object.values(listed.values).some((item) => BigInt(item) === raw)) {
    raw = BigInt(Object.values(listed.values)[0]);
  }
  return asNumber(type, raw);
}

// --- what people write ---------------------------------------------------------------------------

/** The raw value in a text; undefined: it is none. */
export function rawIn(step, text) {
  const { type } = step;
  const own = text.trim();
  if (type.kind === "text") return text;
  if (type.kind === "octets") {
    try {
      return parseHex(text);
    } catch {
      return undefined;
    }
  }
  if (type.kind === "float") {
    const value = { nan: NaN, inf: Infinity, "-inf": -Infinity }[own] ?? Number(own);
    return own === "" || (Number.isNaN(value) && own !== "nan") ? undefined : value;
  }
  const found = /^([+-]?)(0[xX][0-9A-Fa-f]+|0[bB][01]+|\d+)$/.exec(own);
  if (!found) return undefined;
  const raw = BigInt(found[2]) * (found[1] === "-" ? -1n : 1n);
  // What a number does not hold exactly is given as it is: the codec says what is wrong with it.
  if (type.role === "bool") return raw === 0n || raw === 1n ? raw !== 0n : undefined;
  return asNumber(type, raw);
}

/** The raw value nearest to a physical one; undefined: it is none. */
export function rawOfPhysical(step, text) {
  const value = decimalIn(text);
  if (!value) return undefined;
  const raw = over(minus(value, fractionIn(step.offset, 0n)), fractionIn(step.scale, 1n));
  return step.type.kind === "float" ? Number(raw.n) / Number(raw.d) : asNumber(step.type, rounded(raw));
}

export function rawText(step, value) {
  if (value instanceof Uint8Array) return hexOf(value);
  if (typeof value === "boolean") return value ? "1" : "0";
  return value === undefined || value === null ? "" : String(value);
}

/** A value as a JSON line has it. */
export function jsonOf(value) {
  if (value instanceof Uint8Array) return JSON.stringify(hexOf(value).replace(/ /g, "").toLowerCase());
  if (Array.isArray(value)) return `[${value.map(jsonOf).join(", ")}]`;
  if (typeof value === "bigint") return String(value);
  if (Object.is(value, -0)) return "-0.0";
  // Python's JSON has words for what is no finite number.
  if (typeof value === "number" && !Number.isFinite(value)) return String(value);
  if (value !== null && typeof value === "object") {
    const members = Object.entries(value).filter(([, item]) => item !== undefined && item !== null);
    return `{${members.map(([key, item]) => `${JSON.stringify(key.replace(/_+$/, ""))}: ${jsonOf(item)}`).join(", ")}}`;
  }
  return JSON.stringify(value ?? null);
}
