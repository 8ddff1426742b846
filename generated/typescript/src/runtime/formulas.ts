/** Whole numbers that are worked out of fields. Divisors are above 0. */

/** The quotient, rounded down. */
export function floor(over: number, under: number): number {
  return Math.floor(over / under);
}

/** What remains, which is never negative. */
export function modulo(over: number, under: number): number {
  return ((over % under) + under) % under;
}

/** Elements of this size in so many bytes; -1 where a part is left. */
export function elements(bytes: number, size: number): number {
  return modulo(bytes, size) ? -1 : floor(bytes, size);
}

/** The quotient, rounded down. */
export function floorBig(over: bigint, under: bigint): bigint {
  return (over - moduloBig(over, under)) / under;
}

/** What remains, which is never negative. */
export function moduloBig(over: bigint, under: bigint): bigint {
  return ((over % under) + under) % under;
}

/** Elements of this size in so many bytes; -1 where a part is left. */
export function elementsBig(bytes: bigint, size: bigint): bigint {
  return moduloBig(bytes, size) ? -1n : floorBig(bytes, size);
}

/** The bits `low` to `high` of an integer, both included. */
export function bits(value: number | bigint | boolean, low: number, high: number): number {
  const mask = (1n << BigInt(high - low + 1)) - 1n;
  return Number((BigInt(value) >> BigInt(low)) & mask);
}

/** Elements, bytes or characters of a value; 0 of what has none. */
export function sizeOf(value: unknown): number {
  const length = (value as { readonly length?: unknown } | null | undefined)?.length;
  return typeof length === "number" ? length : 0;
}

/** A list of some type that has no elements yet. */
export function noneOf<T>(_values: readonly T[]): T[] {
  return [];
}
