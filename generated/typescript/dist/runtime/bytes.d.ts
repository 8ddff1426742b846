/** Bytes out of texts, and comparisons of bytes. */
export declare const NO_BYTES: Uint8Array;
/** The bytes of hexadecimal digits. */
export declare function hex(digits: string): Uint8Array;
/** Two hexadecimal digits a byte. */
export declare function toHex(bytes: Uint8Array): string;
/** A copy of the first `size` bytes. */
export declare function firstOf(bytes: Uint8Array, size: number): Uint8Array;
/** True if the bytes are the same. */
export declare function equal(one: ArrayLike<number>, other: ArrayLike<number>): boolean;
/** True if `word` stands at a place of the first `size` bytes. */
export declare function standsAt(bytes: ArrayLike<number>, size: number, place: number, word: Uint8Array): boolean;
/** Several pieces, one behind another. */
export declare function concatenated(pieces: readonly ArrayLike<number>[]): Uint8Array;
/** True if one of the bytes has its most significant bit set. */
export declare function hasHighBit(bytes: Uint8Array, from: number, to: number): boolean;
