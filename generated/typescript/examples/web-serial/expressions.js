/** Numbers and conditions that are worked out of earlier fields. */

const floored = (a, b) => a / b - (a % b && a < 0n !== b < 0n ? 1n : 0n);
const modulo = (a, b) => a - floored(a, b) * b;

const OPERATORS = {
  "+": (a, b) => a + b,
  "-": (a, b) => a - b,
  "*": (a, b) => a * b,
  "//": floored,
  "%": modulo,
  "==": (a, b) => a === b,
  "!=": (a, b) => a !== b,
  "<": (a, b) => a < b,
  "<=": (a, b) => a <= b,
  ">": (a, b) => a > b,
  ">=": (a, b) => a >= b,
};

class Missing extends Error {}

/** The value, where `look` gives the integer of a field; null where the bytes did not say it. */
export function said(expression, look) {
  try {
    return BigInt(valueOf(expression, look));
  } catch (error) {
    if (error instanceof Missing) return null;
    throw error;
  }
}

function valueOf(item, look) {
  if (!Array.isArray(item)) return BigInt(item);
  const [kind, ...inside] = item;
  if (kind === "field") return fieldValue(inside, look);
  const number = (inner) => BigInt(valueOf(inner, look));
  if (kind === "minus") return -number(inside[0]);
  if (kind === "not") return !number(inside[0]);
  if (kind === "and" || kind === "or") {
    const [left, right] = inside.map(number);
    return kind === "and" ? left !== 0n && right !== 0n : left !== 0n || right !== 0n;
  }
  if (kind === "in") {
    const [first, ...others] = inside.map(number);
    return others.includes(first);
  }
  if (kind === "elements") {
    const [bytes, size] = [number(inside[0]), BigInt(inside[1])];
    return modulo(bytes, size) ? -1n : floored(bytes, size);
  }
  return OPERATORS[kind](number(inside[0]), number(inside[1]));
}

function fieldValue([name, low, high], look) {
  const value = look(name);
  if (typeof value !== "bigint") throw new Missing();
  return low === undefined ? value : (value >> BigInt(low)) & ((1n << BigInt(high - low + 1)) - 1n);
}
