/** Physical values: raw x factor + term, all divided by a divisor, exact as far as floats are. */
/** What raw values become: each number one of `N`, also in arrays; what is not there stays null. */
export type Physical<T, N> = T extends readonly unknown[] ? N[] : T extends null ? null : N;
/** The physical value of a raw one, or of each in an array; null for a special value. */
export declare function physical<T>(raw: T, factor: bigint, term: bigint, divisor: bigint): Physical<T, number>;
export declare function physical<T>(raw: T, factor: bigint, term: bigint, divisor: bigint, special: readonly (number | bigint)[]): Physical<T, number | null>;
/**
 * The raw integer nearest to a physical value, ties to even.
 *
 * Throws a RangeError where the wire can't hold it, or it is a special value: that would be read back
 * as no reading at all.
 */
export declare function nearest(value: number, factor: bigint, term: bigint, divisor: bigint, low: bigint, high: bigint, special: readonly (number | bigint)[]): bigint;
