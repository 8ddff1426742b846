/** Bytes out of texts, and comparisons of bytes. */

export const NO_BYTES: Uint8Array = new Uint8Array(0);

/** The bytes of hexadecimal digits. */
export function hex(digits: string): Uint8Array {
  const bytes = new Uint8Array(digits.length >> 1);
  for (let index = 0; index < bytes.length; index++) {
    bytes[index] = parseInt(digits.slice(2 * index, 2 * index + 2), 16);
  }
  return bytes;
}

/** Two hexadecimal digits a byte. */
export function toHex(bytes: Uint8Array): string {
  let digits = "";
  for (let index = 0; index < bytes.length; index++) {
    digits += bytes[index]!.toString(16).padStart(2, "0");
  }
  return digits;
}

/** As many bytes are copied one by one at most, which is faster than a call for so few. */
const FEW = 16;

/** A copy of the first `size` bytes. */
export function firstOf(bytes: Uint8Array, size: number): Uint8Array {
  if (size > FEW) return bytes.slice(0, size);
  const copy = new Uint8Array(size);
  for (let index = 0; index < size; index++) copy[index] = bytes[index]!;
  return copy;
}

/** True if the bytes are the same. */
export function equal(one: ArrayLike<number>, other: ArrayLike<number>): boolean {
  if (one.length !== other.length) return false;
  for (let index = 0; index < one.length; index++) if (one[index] !== other[index]) return false;
  return true;
}

/** True if `word` stands at a place of the first `size` bytes. */
export function standsAt(
  bytes: ArrayLike<number>,
  size: number,
  place: number,
  word: Uint8Array,
): boolean {
  if (place < 0 || place + word.length > size) return false;
  for (let index = 0; index < word.length; index++) {
    if (bytes[place + index] !== word[index]) return false;
  }
  return true;
}

/** Several pieces, one behind another. */
export function concatenated(pieces: readonly ArrayLike<number>[]): Uint8Array {
  let size = 0;
  for (const piece of pieces) size += piece.length;
  const bytes = new Uint8Array(size);
  let at = 0;
  for (const piece of pieces) {
    for (let index = 0; index < piece.length; index++) bytes[at++] = piece[index]!;
  }
  return bytes;
}

/** True if one of the bytes has its most significant bit set. */
export function hasHighBit(bytes: Uint8Array, from: number, to: number): boolean {
  for (let place = from; place < to; place++) if (bytes[place]! > 0x7f) return true;
  return false;
}
