/** Transparency: what keeps delimiters out of a region of a frame, and takes it off again. */
/** Decodes one region, byte by byte. Of no use after a Fault or `finish`. */
export declare abstract class Unstuffer {
    /** Bytes that `fill` has put out. */
    filled: number;
    /** Take the next byte of the region; the bytes that it releases. Throws a Fault. */
    abstract push(byte: number): ArrayLike<number>;
    /** Take the end of the region; the bytes that were held back. Throws a Fault. */
    abstract finish(): ArrayLike<number>;
    /** Take bytes up to a place, or until there are `due`; the place behind them. Throws a Fault. */
    fill(data: Uint8Array, from: number, to: number, out: Uint8Array, due: number): number;
}
/** One kind of transparency with its parameters. */
export interface Transparency {
    /** True if only what a sender makes of some bytes is taken off. */
    readonly isStrict: boolean;
    /** The region on the wire that stands for the bytes. */
    encode(bytes: Uint8Array): Uint8Array;
    /** The first `size` bytes, with a region of them as it is on the wire. */
    put(bytes: Uint8Array, size: number, from: number, to: number): Uint8Array;
    /** What takes a region off, from its first byte on. */
    decoder(): Unstuffer;
}
/** Each listed byte is replaced by a sequence. */
export declare function substitution(codes: readonly (readonly [number, Uint8Array])[], lenient?: boolean): Transparency;
/** Some bytes are replaced by the escape byte and themselves, exclusive or `mask`. */
export declare function escape(byte: number, mask: number, codes: readonly (readonly [number, Uint8Array])[], lenient?: boolean): Transparency;
/** Behind each sequence of two bytes or more, a byte is put in. */
export declare function insertion(sequence: Uint8Array, byte: number): Transparency;
/** Each byte is written as two hexadecimal digits in upper case. */
export declare function base16(lenient?: boolean): Transparency;
/** Consistent overhead byte stuffing: the region never contains a zero. */
export declare function cobs(lenient?: boolean): Transparency;
