/** Transparency: what keeps delimiters out of a region of a frame, and takes it off again. */

import { concatenated, equal, NO_BYTES, standsAt } from "./bytes.js";
import { Fault, spelled } from "./errors.js";

/** Decodes one region, byte by byte. Of no use after a Fault or `finish`. */
export interface Unstuffer {
  /** Take the next byte of the region; the bytes that it releases. Throws a Fault. */
  push(byte: number): ArrayLike<number>;
  /** Take the end of the region; the bytes that were held back. Throws a Fault. */
  finish(): ArrayLike<number>;
}

/** One kind of transparency with its parameters. */
export interface Transparency {
  /** The region on the wire that stands for the bytes. */
  encode(bytes: Uint8Array): Uint8Array;
  /** What takes a region off, from its first byte on. */
  decoder(): Unstuffer;
}

/** Each byte by its value, as what a byte releases. */
const BYTES: readonly Uint8Array[] = Array.from({ length: 256 }, (_, byte) => Uint8Array.of(byte));

function cutSequence(held: ArrayLike<number>): Fault {
  return new Fault("stuffing", `the region ends inside a sequence, behind ${spelled(held)}`);
}

// --- substitution ------------------------------------------------------------------------------

interface Node {
  readonly next: Map<number, Node>;
  value: number;
}

/** The sequences of a table, and the bytes that stand for themselves, as a tree. */
function treeOf(codes: readonly (readonly [number, Uint8Array])[]): Node {
  const root: Node = { next: new Map(), value: -1 };
  const listed = new Set(codes.map(([byte]) => byte));
  const plain = BYTES.map((word, byte) => [byte, word] as const);
  for (const [byte, word] of [...codes, ...plain.filter(([byte]) => !listed.has(byte))]) {
    let node = root;
    for (const item of word) {
      let inner = node.next.get(item);
      if (!inner) node.next.set(item, (inner = { next: new Map(), value: -1 }));
      node = inner;
    }
    node.value = byte;
  }
  return root;
}

class StrictSequences implements Unstuffer {
  private node: Node;
  private held: number[] = [];

  constructor(private readonly root: Node) {
    this.node = root;
  }

  push(byte: number): ArrayLike<number> {
    const node = this.node.next.get(byte);
    if (!node) {
      const found = spelled([...this.held, byte]);
      throw new Fault("stuffing", `${found} is no sequence and no plain byte`);
    }
    if (node.value >= 0) {
      this.node = this.root;
      if (this.held.length) this.held = [];
      return BYTES[node.value]!;
    }
    this.node = node;
    this.held.push(byte);
    return NO_BYTES;
  }

  finish(): ArrayLike<number> {
    if (this.held.length) throw cutSequence(this.held);
    return NO_BYTES;
  }
}

/** Where a sequence stands it is replaced; where none does, one byte passes as it is. */
class LenientSequences implements Unstuffer {
  private held: number[] = [];

  constructor(private readonly root: Node) {}

  push(byte: number): ArrayLike<number> {
    this.held.push(byte);
    const released: number[] = [];
    while (this.held.length && !this.isBegun()) this.release(released);
    return released;
  }

  finish(): ArrayLike<number> {
    const released: number[] = [];
    while (this.held.length) this.release(released);
    return released;
  }

  /** True if what is held is the beginning of a longer sequence, and no more. */
  private isBegun(): boolean {
    let node: Node | undefined = this.root;
    for (const byte of this.held) {
      node = node.next.get(byte);
      if (!node) return false;
    }
    return node.next.size > 0;
  }

  private release(released: number[]): void {
    let node: Node | undefined = this.root;
    for (let size = 0; size < this.held.length; size++) {
      node = node.next.get(this.held[size]!);
      if (!node) break;
      if (node.value >= 0) {
        released.push(node.value);
        this.held = this.held.slice(size + 1);
        return;
      }
    }
    released.push(this.held[0]!);
    this.held = this.held.slice(1);
  }
}

/** Each listed byte is replaced by a sequence. */
export function substitution(
  codes: readonly (readonly [number, Uint8Array])[],
  lenient = false,
): Transparency {
  let root: Node | undefined;
  return {
    encode: (bytes) => replaced(bytes, codes),
    decoder() {
      root ??= treeOf(codes);
      return lenient ? new LenientSequences(root) : new StrictSequences(root);
    },
  };
}

function replaced(
  bytes: Uint8Array,
  codes: readonly (readonly [number, Uint8Array])[],
): Uint8Array {
  const words = new Map(codes);
  const out: number[] = [];
  for (const byte of bytes) {
    const word = words.get(byte);
    if (word) out.push(...word);
    else out.push(byte);
  }
  return Uint8Array.from(out);
}

/** Any byte behind the escape byte is transformed back; others stand for themselves. */
class LenientEscape implements Unstuffer {
  private isEscaped = false;

  constructor(
    private readonly escape: number,
    private readonly mask: number,
  ) {}

  push(byte: number): ArrayLike<number> {
    if (this.isEscaped) {
      this.isEscaped = false;
      return BYTES[byte ^ this.mask]!;
    }
    this.isEscaped = byte === this.escape;
    return this.isEscaped ? NO_BYTES : BYTES[byte]!;
  }

  finish(): ArrayLike<number> {
    if (this.isEscaped) throw cutSequence([this.escape]);
    return NO_BYTES;
  }
}

/** Some bytes are replaced by the escape byte and themselves, exclusive or `mask`. */
export function escape(
  byte: number,
  mask: number,
  codes: readonly (readonly [number, Uint8Array])[],
  lenient = false,
): Transparency {
  const strict = substitution(codes);
  return lenient
    ? { encode: strict.encode, decoder: () => new LenientEscape(byte, mask) }
    : strict;
}

// --- a byte that is put in ---------------------------------------------------------------------

/** Holds the last byte of each sequence until the byte behind it is there. */
class Inserted implements Unstuffer {
  private seen: number[] = [];

  constructor(
    private readonly sequence: Uint8Array,
    private readonly byte: number,
  ) {}

  push(byte: number): ArrayLike<number> {
    const last = this.sequence.length;
    if (this.seen.length === last) {
      if (byte !== this.byte) {
        throw new Fault("stuffing", `${spelled([...this.sequence, byte])} is never sent`);
      }
      this.seen = [];
      return BYTES[this.sequence[last - 1]!]!;
    }
    this.seen.push(byte);
    while (this.seen.length && !equal(this.seen, this.sequence.subarray(0, this.seen.length))) {
      this.seen.shift();
    }
    return this.seen.length === last ? NO_BYTES : BYTES[byte]!;
  }

  finish(): ArrayLike<number> {
    if (this.seen.length === this.sequence.length) throw cutSequence(this.sequence);
    return NO_BYTES;
  }
}

/** Behind each sequence of two bytes or more, a byte is put in. */
export function insertion(sequence: Uint8Array, byte: number): Transparency {
  return {
    encode(bytes) {
      const out: number[] = [];
      for (let at = 0; at < bytes.length; ) {
        if (standsAt(bytes, bytes.length, at, sequence)) {
          out.push(...sequence, byte);
          at += sequence.length;
        } else out.push(bytes[at++]!);
      }
      return Uint8Array.from(out);
    },
    decoder: () => new Inserted(sequence, byte),
  };
}

// --- base 16 -----------------------------------------------------------------------------------

class Base16 implements Unstuffer {
  private upper = -1;

  constructor(private readonly lenient: boolean) {}

  push(byte: number): ArrayLike<number> {
    const digit = this.digit(byte);
    if (digit < 0) throw new Fault("encoding", `${spelled([byte])} is no hexadecimal digit`);
    if (this.upper < 0) {
      this.upper = digit;
      return NO_BYTES;
    }
    const decoded = BYTES[this.upper * 16 + digit]!;
    this.upper = -1;
    return decoded;
  }

  finish(): ArrayLike<number> {
    if (this.upper >= 0) throw new Fault("encoding", "the number of hexadecimal digits is odd");
    return NO_BYTES;
  }

  private digit(byte: number): number {
    if (byte >= 0x30 && byte <= 0x39) return byte - 0x30;
    if (byte >= 0x41 && byte <= 0x46) return byte - 0x41 + 10;
    return this.lenient && byte >= 0x61 && byte <= 0x66 ? byte - 0x61 + 10 : -1;
  }
}

/** Each byte is written as two hexadecimal digits in upper case. */
export function base16(lenient = false): Transparency {
  return {
    encode(bytes) {
      const out = new Uint8Array(2 * bytes.length);
      bytes.forEach((byte, index) => {
        const digits = byte.toString(16).toUpperCase().padStart(2, "0");
        out[2 * index] = digits.charCodeAt(0);
        out[2 * index + 1] = digits.charCodeAt(1);
      });
      return out;
    },
    decoder: () => new Base16(lenient),
  };
}

// --- COBS --------------------------------------------------------------------------------------

const FULL_CODE = 0xff;
const ZERO = Uint8Array.of(0);

class CobsDecoder implements Unstuffer {
  private code = 0;
  private left = 0;
  private isNeedless = false;

  constructor(private readonly lenient: boolean) {}

  push(byte: number): ArrayLike<number> {
    if (byte === 0) throw new Fault("encoding", "COBS never writes a zero");
    if (this.left) {
      this.left--;
      return BYTES[byte]!;
    }
    // Only now is it known that the group before was not the last, so that its zero is due.
    const released = this.code > 0 && this.code < FULL_CODE ? ZERO : NO_BYTES;
    this.isNeedless = byte === 1 && this.code === FULL_CODE;
    this.code = byte;
    this.left = byte - 1;
    return released;
  }

  finish(): ArrayLike<number> {
    if (this.left) throw new Fault("encoding", `bytes missing in the last group: ${this.left}`);
    if (this.lenient) return NO_BYTES;
    if (this.code === 0) throw new Fault("encoding", "COBS writes 01 for no data, not nothing");
    if (this.isNeedless) {
      throw new Fault("encoding", "COBS ends behind a full group without 01");
    }
    return NO_BYTES;
  }
}

/** Consistent overhead byte stuffing: the region never contains a zero. */
export function cobs(lenient = false): Transparency {
  return {
    encode(bytes) {
      const groups: Uint8Array[] = [];
      let start = 0;
      for (let at = 0; at <= bytes.length; at++) {
        if (at - start === FULL_CODE - 1) {
          groups.push(Uint8Array.of(FULL_CODE), bytes.subarray(start, at));
          if (at === bytes.length) break; // Behind a full group, the end needs no group of its own.
          start = at;
        }
        if (at === bytes.length || bytes[at] === 0) {
          groups.push(Uint8Array.of(at - start + 1), bytes.subarray(start, at));
          start = at + 1;
        }
      }
      return concatenated(groups);
    },
    decoder: () => new CobsDecoder(lenient),
  };
}
