/** Transparency: what keeps delimiters out of a region of a frame, and takes it off again. */
import { concatenated, equal, NO_BYTES, standsAt } from "./bytes.js";
import { Fault, spelled } from "./errors.js";
/** Each byte by its value, as what a byte releases. */
const BYTES = Array.from({ length: 256 }, (_, byte) => Uint8Array.of(byte));
function cutSequence(held) {
    return new Fault("stuffing", `the region ends inside a sequence, behind ${spelled(held)}`);
}
/** The sequences of a table, and the bytes that stand for themselves, as a tree. */
function treeOf(codes) {
    const root = { next: new Map(), value: -1 };
    const listed = new Set(codes.map(([byte]) => byte));
    const plain = BYTES.map((word, byte) => [byte, word]);
    for (const [byte, word] of [...codes, ...plain.filter(([byte]) => !listed.has(byte))]) {
        let node = root;
        for (const item of word) {
            let inner = node.next.get(item);
            if (!inner)
                node.next.set(item, (inner = { next: new Map(), value: -1 }));
            node = inner;
        }
        node.value = byte;
    }
    return root;
}
class StrictSequences {
    constructor(root) {
        this.root = root;
        this.held = [];
        this.node = root;
    }
    push(byte) {
        const node = this.node.next.get(byte);
        if (!node) {
            const found = spelled([...this.held, byte]);
            throw new Fault("stuffing", `${found} is no sequence and no plain byte`);
        }
        if (node.value >= 0) {
            this.node = this.root;
            if (this.held.length)
                this.held = [];
            return BYTES[node.value];
        }
        this.node = node;
        this.held.push(byte);
        return NO_BYTES;
    }
    finish() {
        if (this.held.length)
            throw cutSequence(this.held);
        return NO_BYTES;
    }
}
/** Where a sequence stands it is replaced; where none does, one byte passes as it is. */
class LenientSequences {
    constructor(root) {
        this.root = root;
        this.held = [];
    }
    push(byte) {
        this.held.push(byte);
        const released = [];
        while (this.held.length && !this.isBegun())
            this.release(released);
        return released;
    }
    finish() {
        const released = [];
        while (this.held.length)
            this.release(released);
        return released;
    }
    /** True if what is held is the beginning of a longer sequence, and no more. */
    isBegun() {
        let node = this.root;
        for (const byte of this.held) {
            node = node.next.get(byte);
            if (!node)
                return false;
        }
        return node.next.size > 0;
    }
    release(released) {
        let node = this.root;
        for (let size = 0; size < this.held.length; size++) {
            node = node.next.get(this.held[size]);
            if (!node)
                break;
            if (node.value >= 0) {
                released.push(node.value);
                this.held = this.held.slice(size + 1);
                return;
            }
        }
        released.push(this.held[0]);
        this.held = this.held.slice(1);
    }
}
/** Each listed byte is replaced by a sequence. */
export function substitution(codes, lenient = false) {
    let root;
    return {
        encode: (bytes) => replaced(bytes, codes),
        decoder() {
            root ?? (root = treeOf(codes));
            return lenient ? new LenientSequences(root) : new StrictSequences(root);
        },
    };
}
function replaced(bytes, codes) {
    const words = new Map(codes);
    const out = [];
    for (const byte of bytes) {
        const word = words.get(byte);
        if (word)
            out.push(...word);
        else
            out.push(byte);
    }
    return Uint8Array.from(out);
}
/** Any byte behind the escape byte is transformed back; others stand for themselves. */
class LenientEscape {
    constructor(escape, mask) {
        this.escape = escape;
        this.mask = mask;
        this.isEscaped = false;
    }
    push(byte) {
        if (this.isEscaped) {
            this.isEscaped = false;
            return BYTES[byte ^ this.mask];
        }
        this.isEscaped = byte === this.escape;
        return this.isEscaped ? NO_BYTES : BYTES[byte];
    }
    finish() {
        if (this.isEscaped)
            throw cutSequence([this.escape]);
        return NO_BYTES;
    }
}
/** Some bytes are replaced by the escape byte and themselves, exclusive or `mask`. */
export function escape(byte, mask, codes, lenient = false) {
    const strict = substitution(codes);
    return lenient
        ? { encode: strict.encode, decoder: () => new LenientEscape(byte, mask) }
        : strict;
}
// --- a byte that is put in ---------------------------------------------------------------------
/** Holds the last byte of each sequence until the byte behind it is there. */
class Inserted {
    constructor(sequence, byte) {
        this.sequence = sequence;
        this.byte = byte;
        this.seen = [];
    }
    push(byte) {
        const last = this.sequence.length;
        if (this.seen.length === last) {
            if (byte !== this.byte) {
                throw new Fault("stuffing", `${spelled([...this.sequence, byte])} is never sent`);
            }
            this.seen = [];
            return BYTES[this.sequence[last - 1]];
        }
        this.seen.push(byte);
        while (this.seen.length && !equal(this.seen, this.sequence.subarray(0, this.seen.length))) {
            this.seen.shift();
        }
        return this.seen.length === last ? NO_BYTES : BYTES[byte];
    }
    finish() {
        if (this.seen.length === this.sequence.length)
            throw cutSequence(this.sequence);
        return NO_BYTES;
    }
}
/** Behind each sequence of two bytes or more, a byte is put in. */
export function insertion(sequence, byte) {
    return {
        encode(bytes) {
            const out = [];
            for (let at = 0; at < bytes.length;) {
                if (standsAt(bytes, bytes.length, at, sequence)) {
                    out.push(...sequence, byte);
                    at += sequence.length;
                }
                else
                    out.push(bytes[at++]);
            }
            return Uint8Array.from(out);
        },
        decoder: () => new Inserted(sequence, byte),
    };
}
// --- base 16 -----------------------------------------------------------------------------------
class Base16 {
    constructor(lenient) {
        this.lenient = lenient;
        this.upper = -1;
    }
    push(byte) {
        const digit = this.digit(byte);
        if (digit < 0)
            throw new Fault("encoding", `${spelled([byte])} is no hexadecimal digit`);
        if (this.upper < 0) {
            this.upper = digit;
            return NO_BYTES;
        }
        const decoded = BYTES[this.upper * 16 + digit];
        this.upper = -1;
        return decoded;
    }
    finish() {
        if (this.upper >= 0)
            throw new Fault("encoding", "the number of hexadecimal digits is odd");
        return NO_BYTES;
    }
    digit(byte) {
        if (byte >= 0x30 && byte <= 0x39)
            return byte - 0x30;
        if (byte >= 0x41 && byte <= 0x46)
            return byte - 0x41 + 10;
        return this.lenient && byte >= 0x61 && byte <= 0x66 ? byte - 0x61 + 10 : -1;
    }
}
/** Each byte is written as two hexadecimal digits in upper case. */
export function base16(lenient = false) {
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
class CobsDecoder {
    constructor(lenient) {
        this.lenient = lenient;
        this.code = 0;
        this.left = 0;
        this.isNeedless = false;
    }
    push(byte) {
        if (byte === 0)
            throw new Fault("encoding", "COBS never writes a zero");
        if (this.left) {
            this.left--;
            return BYTES[byte];
        }
        // Only now is it known that the group before was not the last, so that its zero is due.
        const released = this.code > 0 && this.code < FULL_CODE ? ZERO : NO_BYTES;
        this.isNeedless = byte === 1 && this.code === FULL_CODE;
        this.code = byte;
        this.left = byte - 1;
        return released;
    }
    finish() {
        if (this.left)
            throw new Fault("encoding", `bytes missing in the last group: ${this.left}`);
        if (this.lenient)
            return NO_BYTES;
        if (this.code === 0)
            throw new Fault("encoding", "COBS writes 01 for no data, not nothing");
        if (this.isNeedless) {
            throw new Fault("encoding", "COBS ends behind a full group without 01");
        }
        return NO_BYTES;
    }
}
/** Consistent overhead byte stuffing: the region never contains a zero. */
export function cobs(lenient = false) {
    return {
        encode(bytes) {
            const groups = [];
            let start = 0;
            for (let at = 0; at <= bytes.length; at++) {
                if (at - start === FULL_CODE - 1) {
                    groups.push(Uint8Array.of(FULL_CODE), bytes.subarray(start, at));
                    if (at === bytes.length)
                        break; // Behind a full group, the end needs no group of its own.
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
