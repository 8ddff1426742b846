/** Transparency: what keeps delimiters out of a region of a frame, and takes it off again. */
import { concatenated, equal, firstOf, NO_BYTES, standsAt } from "./bytes.js";
import { Fault, spelled } from "./errors.js";
/** Decodes one region, byte by byte. Of no use after a Fault or `finish`. */
export class Unstuffer {
    constructor() {
        /** Bytes that `fill` has put out. */
        this.filled = 0;
    }
    /** Take bytes up to a place, or until there are `due`; the place behind them. Throws a Fault. */
    fill(data, from, to, out, due) {
        let place = from;
        while (place < to && this.filled < due) {
            const released = this.push(data[place++]);
            for (let index = 0; index < released.length; index++)
                out[this.filled++] = released[index];
        }
        return place;
    }
}
function putBy(encode) {
    return (bytes, size, from, to) => {
        const region = encode(bytes.slice(from, to));
        const wire = new Uint8Array(size - (to - from) + region.length);
        wire.set(bytes.subarray(0, from));
        wire.set(region, from);
        wire.set(bytes.subarray(to, size), from + region.length);
        return wire;
    };
}
/** Each byte by its value, as what a byte releases. */
const BYTES = Array.from({ length: 256 }, (_, byte) => Uint8Array.of(byte));
function cutSequence(held) {
    return new Fault("stuffing", `the region ends inside a sequence, behind ${spelled(held)}`);
}
function sequencesOf(codes) {
    const steps = BYTES.map((_, byte) => byte);
    const beginnings = [[]];
    for (const [byte] of codes)
        steps[byte] = -1;
    for (const [byte, word] of codes) {
        let node = 0;
        word.forEach((item, index) => {
            const at = 256 * node + item;
            if (index === word.length - 1)
                steps[at] = byte;
            else {
                if (steps[at] > -2) {
                    steps[at] = -2 - beginnings.length;
                    beginnings.push([...word.subarray(0, index + 1)]);
                    for (let count = 0; count < 256; count++)
                        steps.push(-1);
                }
                node = -2 - steps[at];
            }
        });
    }
    return { steps: Int16Array.from(steps), beginnings };
}
class StrictSequences extends Unstuffer {
    constructor(sequences) {
        super();
        this.sequences = sequences;
        this.node = 0;
    }
    push(byte) {
        const step = this.sequences.steps[256 * this.node + byte];
        if (step === -1)
            throw this.none(byte);
        this.node = step < 0 ? -2 - step : 0;
        return step < 0 ? NO_BYTES : BYTES[step];
    }
    fill(data, from, to, out, due) {
        const { steps } = this.sequences;
        let { filled, node } = this;
        let place = from;
        while (place < to && filled < due) {
            const last = node ? place : Math.min(to, place + due - filled);
            // Most bytes stand for themselves.
            for (let step; place < last && (step = steps[data[place]]) >= 0; place++) {
                out[filled++] = step;
            }
            if (place === to || filled === due)
                break;
            const byte = data[place++];
            const step = steps[256 * node + byte];
            if (step >= 0) {
                out[filled++] = step;
                node = 0;
            }
            else {
                this.node = node;
                if (step === -1)
                    throw this.none(byte);
                node = -2 - step;
            }
        }
        this.filled = filled;
        this.node = node;
        return place;
    }
    none(byte) {
        const found = spelled([...this.sequences.beginnings[this.node], byte]);
        return new Fault("stuffing", `${found} is no sequence and no plain byte`);
    }
    finish() {
        if (this.node)
            throw cutSequence(this.sequences.beginnings[this.node]);
        return NO_BYTES;
    }
}
/** Where a sequence stands it is replaced; where none does, one byte passes as it is. */
class LenientSequences extends Unstuffer {
    constructor(sequences) {
        super();
        this.sequences = sequences;
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
        let node = 0;
        for (const byte of this.held) {
            const step = this.sequences.steps[256 * node + byte];
            if (step >= -1)
                return false;
            node = -2 - step;
        }
        return true;
    }
    release(released) {
        let node = 0;
        for (let size = 0; size < this.held.length; size++) {
            const step = this.sequences.steps[256 * node + this.held[size]];
            if (step >= 0) {
                released.push(step);
                this.held = this.held.slice(size + 1);
                return;
            }
            if (step === -1)
                break;
            node = -2 - step;
        }
        released.push(this.held[0]);
        this.held = this.held.slice(1);
    }
}
/** Each listed byte is replaced by a sequence. */
export function substitution(codes, lenient = false) {
    let sequences;
    let words;
    const put = (bytes, size, from, to) => {
        words ?? (words = wordsOf(codes));
        const more = added(words.more, bytes, from, to);
        if (!more)
            return firstOf(bytes, size);
        return replaced(bytes, from, to, words.words, new Uint8Array(size + more));
    };
    return {
        isStrict: !lenient,
        encode: (bytes) => put(bytes, bytes.length, 0, bytes.length),
        put,
        decoder() {
            sequences ?? (sequences = sequencesOf(codes));
            return lenient ? new LenientSequences(sequences) : new StrictSequences(sequences);
        },
    };
}
function wordsOf(codes) {
    const words = BYTES.map(() => null);
    for (const [byte, word] of codes)
        words[byte] = word;
    return { more: Uint8Array.from(words, (word) => (word ? word.length - 1 : 0)), words };
}
/** Bytes that are replaced in a run of some. */
function added(more, bytes, from, to) {
    let count = 0;
    for (let index = from; index < to; index++)
        count += more[bytes[index]];
    return count;
}
/** Some bytes, of which those in a run are replaced. */
function replaced(bytes, from, to, words, out) {
    let at = 0;
    for (; at < from; at++)
        out[at] = bytes[at];
    for (let index = from; index < to; index++) {
        const word = words[bytes[index]];
        if (!word)
            out[at++] = bytes[index];
        else
            for (let place = 0; place < word.length; place++)
                out[at++] = word[place];
    }
    for (let index = to; at < out.length; index++)
        out[at++] = bytes[index];
    return out;
}
/** Any byte behind the escape byte is transformed back; others stand for themselves. */
class LenientEscape extends Unstuffer {
    constructor(escape, mask) {
        super();
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
        ? { ...strict, isStrict: false, decoder: () => new LenientEscape(byte, mask) }
        : strict;
}
// --- a byte that is put in ---------------------------------------------------------------------
/** Holds the last byte of each sequence until the byte behind it is there. */
class Inserted extends Unstuffer {
    constructor(sequence, byte) {
        super();
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
    const encode = (bytes) => {
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
    };
    return {
        isStrict: true,
        encode,
        put: putBy(encode),
        decoder: () => new Inserted(sequence, byte),
    };
}
// --- base 16 -----------------------------------------------------------------------------------
class Base16 extends Unstuffer {
    constructor(lenient) {
        super();
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
    const encode = (bytes) => {
        const out = new Uint8Array(2 * bytes.length);
        bytes.forEach((byte, index) => {
            const digits = byte.toString(16).toUpperCase().padStart(2, "0");
            out[2 * index] = digits.charCodeAt(0);
            out[2 * index + 1] = digits.charCodeAt(1);
        });
        return out;
    };
    return {
        isStrict: !lenient,
        encode,
        put: putBy(encode),
        decoder: () => new Base16(lenient),
    };
}
// --- COBS --------------------------------------------------------------------------------------
const FULL_CODE = 0xff;
const ZERO = Uint8Array.of(0);
class CobsDecoder extends Unstuffer {
    constructor(lenient) {
        super();
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
    const encode = (bytes) => {
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
    };
    return {
        isStrict: !lenient,
        encode,
        put: putBy(encode),
        decoder: () => new CobsDecoder(lenient),
    };
}
