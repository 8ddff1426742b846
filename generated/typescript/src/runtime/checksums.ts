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

function folded(width: number, folding: Folding, isSum: boolean): Checksum {
  const mask = 2 ** width - 1;
  const size = folding.words === undefined ? 1 : width / 8;
  const little = folding.words === "little";
  const { init = 0, xorout = 0, mask: kept = mask, add = 0, negated = false } = folding;
  // As an integer of 32 bits: its negative bits are those above, too.
  const bits = mask | 0;
  function wordOf(bytes: Uint8Array, at: number, to: number): number {
    let word = 0;
    for (let index = 0; index < size; index++) {
      const place = little ? at + size - 1 - index : at + index;
      word = word * 256 + (place < to ? bytes[place]! : 0);
    }
    return word;
  }
  function result(register: number): number {
    const folded = (negated ? -register : register) & bits;
    return ((((folded ^ xorout) & kept) + add) & bits) >>> 0;
  }
  if (size > 1) {
    return {
      compute(bytes, from, to) {
        let register = init;
        for (let at = from; at < to; at += size) {
          const word = wordOf(bytes, at, to);
          register = (isSum ? register + word : register ^ word) >>> 0;
        }
        return result(register);
      },
    };
  }
  if (isSum) {
    return {
      compute(bytes, from, to) {
        let register = init;
        for (let at = from; at < to; at++) register = (register + bytes[at]!) | 0;
        return result(register);
      },
    };
  }
  return {
    compute(bytes, from, to) {
      let register = init;
      for (let at = from; at < to; at++) register ^= bytes[at]!;
      return result(register);
    },
  };
}

/** The exclusive or of all bytes or words. */
export function xor(width = 8, folding: Folding = {}): Checksum {
  return folded(width, folding, false);
}

/** The sum of all bytes or words. */
export function sum(width = 8, folding: Folding = {}): Checksum {
  return folded(width, folding, true);
}

/** Fletcher's checksum of bytes: the sum is the low byte, that of the running sums the high one. */
export function fletcher16(modulus = 255): Checksum {
  return {
    compute(bytes, from, to) {
      let one = 0;
      let two = 0;
      for (let index = from; index < to; index++) {
        one = (one + bytes[index]!) % modulus;
        two = (two + one) % modulus;
      }
      return two * 256 + one;
    },
  };
}

/** Parameters of a CRC, as the catalogue has them, `init` and `poly` with the highest bit first. */
export interface CrcParameters {
  readonly poly: bigint;
  readonly init?: bigint;
  readonly refin?: boolean;
  readonly refout?: boolean;
  readonly xorout?: bigint;
}

function reversed(value: bigint, width: number): bigint {
  let found = 0n;
  for (let bit = 0; bit < width; bit++) if ((value >> BigInt(bit)) & 1n) {
    found |= 1n << BigInt(width - 1 - bit);
  }
  return found;
}

/**
 * A cyclic redundancy check of `width` bits.
 *
 * The register holds bits in the order in which they enter: of a reflected CRC the lowest bit is the
 * next one; of another, which is kept in at least 8 bits, the highest.
 */
export function crc(width: number, parameters: CrcParameters): Checksum {
  const { poly, init = 0n, refin = false, refout = false, xorout = 0n } = parameters;
  return width <= 32
    ? narrowCrc(width, Number(poly), Number(init), refin, refout, Number(xorout))
    : wideCrc(width, poly, init, refin, refout, xorout);
}

function narrowCrc(
  width: number,
  poly: number,
  init: number,
  refin: boolean,
  refout: boolean,
  xorout: number,
): Checksum {
  // One that is not reflected stands in the highest bits of 32.
  const shift = 32 - width;
  const turned = (value: number): number => Number(reversed(BigInt(value), width));
  const divisor = refin ? turned(poly) : (poly << shift) >>> 0;
  const first = refin ? turned(init) : (init << shift) >>> 0;
  let table: Uint32Array | undefined;
  function entry(byte: number): number {
    let register = refin ? byte : byte << 24;
    for (let bit = 0; bit < 8; bit++) {
      const isOut = refin ? register & 1 : register >>> 31;
      register = refin ? register >>> 1 : register << 1;
      if (isOut) register ^= divisor;
    }
    return register >>> 0;
  }
  return {
    compute(bytes, from, to) {
      table ??= Uint32Array.from({ length: 256 }, (_, byte) => entry(byte));
      let register = first;
      if (refin) {
        for (let index = from; index < to; index++) {
          register = (register >>> 8) ^ table[(register ^ bytes[index]!) & 0xff]!;
        }
      } else {
        for (let index = from; index < to; index++) {
          register = (register << 8) ^ table[(register >>> 24) ^ bytes[index]!]!;
        }
        register >>>= shift;
      }
      register >>>= 0;
      return ((refin !== refout ? turned(register) : register) ^ xorout) >>> 0;
    },
  };
}

function wideCrc(
  width: number,
  poly: bigint,
  init: bigint,
  refin: boolean,
  refout: boolean,
  xorout: bigint,
): Checksum {
  const size = BigInt(width);
  const mask = (1n << size) - 1n;
  const divisor = refin ? reversed(poly, width) : poly;
  return {
    compute(bytes, from, to) {
      let register = refin ? reversed(init, width) : init;
      for (let index = from; index < to; index++) {
        const byte = BigInt(bytes[index]!);
        register ^= refin ? byte : byte << (size - 8n);
        for (let bit = 0; bit < 8; bit++) {
          const isOut = refin ? register & 1n : register >> (size - 1n);
          register = refin ? register >> 1n : (register << 1n) & mask;
          if (isOut) register ^= divisor;
        }
      }
      return (refin !== refout ? reversed(register, width) : register) ^ xorout;
    },
  };
}
