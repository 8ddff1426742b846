/** Whole numbers that are worked out of fields. Divisors are above 0. */

/** The quotient, rounded down. */
export function floor(over: number, under: number): number;
export function floor(over: bigint, under: bigint): bigint;
export function floor(over: any, under: any): any {
  return (over - modulo(over, under)) / under;
}

/** What remains, which is never negative. */
export function modulo(over: number, under: number): number;
export function modulo(over: bigint, under: bigint): bigint;
export function modulo(over: any, under: any): any {
  return ((over % under) + under) % under;
}

/** Elements of this size in so many bytes; -1 where a part is left. */
export function elements(bytes: number, size: number): number;
export function elements(bytes: bigint, size: bigint): bigint;
export function elements(bytes: any, size: any): any {
  if (modulo(bytes, size)) return typeof bytes === "bigint" ? -1n : -1;
  return bytes / size;
}

/** The bits `low` to `high` of an integer, both included. */
export function bits(value: number | bigint | boolean, low: number, high: number): number {
  const mask = (1n << BigInt(high - low + 1)) - 1n;
  return Number((BigInt(value) >> BigInt(low)) & mask);
}

/**
 * The number that counts so many elements, bytes or characters: times `factor`, and `offset` more,
 * it is the number of bytes, of which each element has `size`. What has none counts as none.
 */
export function counted(value: unknown, factor: number, offset: number, size: number): number {
  const length = (value as { readonly length?: unknown } | null | undefined)?.length;
  const count = typeof length === "number" ? length : 0;
  return Math.floor((count * size - offset) / factor);
}

/** A list of some type that has no elements yet. */
export function noneOf<T>(_values: readonly T[]): T[] {
  return [];
}
