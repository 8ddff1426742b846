/** Whole numbers that are worked out of fields. Divisors are above 0. */
/** The quotient, rounded down. */
export declare function floor(over: number, under: number): number;
/** What remains, which is never negative. */
export declare function modulo(over: number, under: number): number;
/** Elements of this size in so many bytes; -1 where a part is left. */
export declare function elements(bytes: number, size: number): number;
/** The quotient, rounded down. */
export declare function floorBig(over: bigint, under: bigint): bigint;
/** What remains, which is never negative. */
export declare function moduloBig(over: bigint, under: bigint): bigint;
/** Elements of this size in so many bytes; -1 where a part is left. */
export declare function elementsBig(bytes: bigint, size: bigint): bigint;
/** The bits `low` to `high` of an integer, both included. */
export declare function bits(value: number | bigint | boolean, low: number, high: number): number;
/** Elements, bytes or characters of a value; 0 of what has none. */
export declare function sizeOf(value: unknown): number;
/** A list of some type that has no elements yet. */
export declare function noneOf<T>(_values: readonly T[]): T[];
