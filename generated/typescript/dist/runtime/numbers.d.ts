/** Numbers of frames: integers of some bits in whole bytes, as digits, or as characters. */
import { Fault } from "./errors.js";
/** Value of a part: a number, a `bigint` where it has more than 53 bits, or a text. */
export type Value = number | bigint | string;
/** Reads and writes the number of a part. */
export interface PartNumber {
    /** Bytes before any stuffing. */
    readonly size: number;
    /** True if it is an unsigned integer that fills whole bytes. */
    readonly isPlain: boolean;
    /** The value of the bytes there. Throws a Fault where no value has them. */
    decode(bytes: ArrayLike<number>, at: number): Value;
    /** Write the value. Throws an EncodeError with an empty path where it does not fit. */
    encode(value: Value, out: Uint8Array, at: number): void;
    /** The value of what a caller gives. Throws an EncodeError with an empty path. */
    given(value: unknown): Value;
}
export type Order = "little" | "big";
export declare function eighthBit(byte: number): Fault;
/** An integer of 1 to 64 bits in as few whole bytes as hold it. */
export declare function number(bits: number, order?: Order, sevenBit?: boolean): PartNumber;
/** An integer that is some bits of another one. */
export declare function bitsNumber(bits: number, low: number, size: number, order?: Order, sevenBit?: boolean): PartNumber;
/** An integer as so many digits out of `alphabet`, the most significant one first. */
export declare function digits(bits: number, alphabet: Uint8Array, size: number): PartNumber;
/** A text of up to `size` characters, which zeros fill up. */
export declare function characters(size: number, sevenBit?: boolean): PartNumber;
