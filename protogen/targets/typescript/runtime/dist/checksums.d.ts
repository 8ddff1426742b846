/** Checksums: exclusive or, sum, Fletcher and every CRC of 1 to 64 bits. */
import type { Order } from "./numbers.js";
/** A checksum algorithm. */
export interface Checksum {
    /** The checksum of bytes from a place to another; a `bigint` where it has more than 32 bits. */
    compute(bytes: Uint8Array, from: number, to: number): number | bigint;
}
/** What a sum or an exclusive or begins with, takes, and is changed by at the end. */
export interface Folding {
    readonly init?: number;
    readonly xorout?: number;
    readonly mask?: number;
    readonly add?: number;
    /** Order of the bytes of words; without it, bytes are taken. */
    readonly words?: Order;
    /** True for what brings the sum to 0. */
    readonly negated?: boolean;
}
/** The exclusive or of all bytes or words. */
export declare function xor(width?: number, folding?: Folding): Checksum;
/** The sum of all bytes or words. */
export declare function sum(width?: number, folding?: Folding): Checksum;
/** Fletcher's checksum of bytes: the sum is the low byte, that of the running sums the high one. */
export declare function fletcher16(modulus?: number): Checksum;
/** Parameters of a CRC, as the catalogue has them, `init` and `poly` with the highest bit first. */
export interface CrcParameters {
    readonly poly: bigint;
    readonly init?: bigint;
    readonly refin?: boolean;
    readonly refout?: boolean;
    readonly xorout?: bigint;
}
/**
 * A cyclic redundancy check of `width` bits.
 *
 * The register holds bits in the order in which they enter: of a reflected CRC the lowest bit is the
 * next one; of another, which is kept in at least 8 bits, the highest.
 */
export declare function crc(width: number, parameters: CrcParameters): Checksum;
