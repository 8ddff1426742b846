/** Physical values: raw x factor + term, all divided by a divisor, exact as far as floats are. */
/** The physical value of a raw one. */
export declare function physical(raw: number | bigint, factor: bigint, term: bigint, divisor: bigint): number;
/**
 * The raw integer nearest to a physical value, ties to even.
 *
 * Throws a RangeError where the wire can't hold it, or it is a special value: that would be read back
 * as no reading at all.
 */
export declare function nearest(value: number, factor: bigint, term: bigint, divisor: bigint, low: bigint, high: bigint, special: readonly (number | bigint)[]): bigint;
