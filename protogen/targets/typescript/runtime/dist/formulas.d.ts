/** Whole numbers that are worked out of fields. Divisors are above 0. */
/** The quotient, rounded down. */
export declare function floor(over: number, under: number): number;
export declare function floor(over: bigint, under: bigint): bigint;
/** What remains, which is never negative. */
export declare function modulo(over: number, under: number): number;
export declare function modulo(over: bigint, under: bigint): bigint;
/** Elements of this size in so many bytes; -1 where a part is left. */
export declare function elements(bytes: number, size: number): number;
export declare function elements(bytes: bigint, size: bigint): bigint;
/** The bits `low` to `high` of an integer, both included. */
export declare function bits(value: number | bigint | boolean, low: number, high: number): number;
/**
 * The number that counts so many elements, bytes or characters: times `factor`, and `offset` more,
 * it is the number of bytes, of which each element has `size`. What has none counts as none.
 */
export declare function counted(value: unknown, factor: number, offset: number, size: number): number;
/** A list of some type that has no elements yet. */
export declare function noneOf<T>(_values: readonly T[]): T[];
