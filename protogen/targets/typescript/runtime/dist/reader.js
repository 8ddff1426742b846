/** Reads the values of a payload, one after another. Generated functions call it. */
import { equal } from "./bytes.js";
import { Fault, joined, spelled } from "./errors.js";
import { NO_PARTS, ownOf } from "./plan.js";
/** Form of a text whose bytes are its characters, with NUL as padding. */
export const PLAIN_TEXT = { padding: 0, bits: 8, shift: 0, add: 0 };
const WORD = new DataView(new ArrayBuffer(8));
/**
 * A place in a payload. Each method takes what is there, or throws a Fault with the path.
 *
 * The last argument of most methods is the name of the field or the index of the element.
 */
export class Reader {
    /** `held` has the parts of the frame that are fields. */
    constructor(bytes, held = NO_PARTS) {
        this.bytes = bytes;
        this.held = held;
        /** The place of the next byte. */
        this.at = 0;
        this.path = [];
        this.depth = 0;
        this.regions = 0;
        this.end = bytes.length;
    }
    /** Begin at another payload. */
    restart(bytes, at, end, held = NO_PARTS) {
        this.bytes = bytes;
        this.held = held;
        this.at = at;
        this.end = end;
        this.regions = 0;
        this.depth = 0;
        return this;
    }
    /** The Fault of a field. */
    fault(step, reason, problem, missing = 0) {
        // More bytes behind a region would not help.
        const more = this.regions ? 0 : missing;
        const path = joined([...this.path.slice(0, this.depth), step]);
        return new Fault(reason, problem, path, this.at, more);
    }
    /** Begin what lies inside of a field or an element. */
    enter(step) {
        this.path[this.depth++] = step;
    }
    /** End what lies inside of it. */
    leave() {
        this.depth--;
    }
    /** Bytes that are left. */
    get left() {
        return this.end - this.at;
    }
    /** The place of so many bytes, which are taken. */
    take(size, step) {
        const at = this.at;
        if (at + size > this.end)
            throw this.short(size, step);
        this.at = at + size;
        return at;
    }
    short(size, step) {
        const problem = `needs ${size} bytes, but only ${this.left} are left`;
        return this.fault(step, "size", problem, size - this.left);
    }
    // --- parts of the frame --------------------------------------------------------------------
    /** A number of up to 53 bits that the frame has. */
    part(name, step) {
        return this.heldPart(name, step);
    }
    /** A number of more bits that the frame has. */
    bigPart(name, step) {
        return this.heldPart(name, step);
    }
    heldPart(name, step) {
        const value = ownOf(this.held, name);
        if (value === undefined)
            throw this.fault(step, "value", `is ${name} of the frame: give it`);
        return value;
    }
    // --- integers ------------------------------------------------------------------------------
    u8(step) {
        return this.bytes[this.take(1, step)];
    }
    i8(step) {
        return (this.u8(step) << 24) >> 24;
    }
    u16(step) {
        const at = this.take(2, step);
        return this.bytes[at] | (this.bytes[at + 1] << 8);
    }
    u16be(step) {
        const at = this.take(2, step);
        return (this.bytes[at] << 8) | this.bytes[at + 1];
    }
    i16(step) {
        return (this.u16(step) << 16) >> 16;
    }
    i16be(step) {
        return (this.u16be(step) << 16) >> 16;
    }
    i32(step) {
        const at = this.take(4, step);
        const b = this.bytes;
        return b[at] | (b[at + 1] << 8) | (b[at + 2] << 16) | (b[at + 3] << 24);
    }
    i32be(step) {
        const at = this.take(4, step);
        const b = this.bytes;
        return (b[at] << 24) | (b[at + 1] << 16) | (b[at + 2] << 8) | b[at + 3];
    }
    u32(step) {
        return this.i32(step) >>> 0;
    }
    u32be(step) {
        return this.i32be(step) >>> 0;
    }
    u64(step) {
        const low = this.u32(step);
        return (BigInt(this.u32(step)) << 32n) | BigInt(low);
    }
    u64be(step) {
        const high = this.u32be(step);
        return (BigInt(high) << 32n) | BigInt(this.u32be(step));
    }
    i64(step) {
        return BigInt.asIntN(64, this.u64(step));
    }
    i64be(step) {
        return BigInt.asIntN(64, this.u64be(step));
    }
    /** An unsigned integer of 7 bits. */
    u7(step) {
        const found = this.u8(step);
        if (found > 0x7f)
            throw this.eighthBit(found, step);
        return found;
    }
    /** One of 14 bits, 7 in each byte, the least significant ones first. */
    u14(step) {
        const at = this.take(2, step);
        const low = this.bytes[at];
        const high = this.bytes[at + 1];
        if ((low | high) > 0x7f)
            throw this.eighthBit(high > 0x7f ? high : low, step);
        return low | (high << 7);
    }
    i14(step) {
        return (this.u14(step) << 18) >> 18;
    }
    /** An unsigned integer of up to 53 bits in bytes of 8 bits or, if `base` is 128, of 7. */
    uint(size, bits, little, base, step) {
        const start = this.take(size, step);
        const { bytes } = this;
        const first = little ? start + size - 1 : start;
        let raw = bytes[first];
        if (raw >= base)
            throw this.eighthBit(raw, step);
        for (let index = 1; index < size; index++) {
            const byte = bytes[little ? first - index : first + index];
            if (byte >= base)
                throw this.eighthBit(byte, step);
            raw = raw * base + byte;
        }
        if (raw >= 2 ** bits)
            throw this.padding(bits, step);
        return raw;
    }
    /** A signed integer of up to 53 bits; two's complement in its bits. */
    sint(size, bits, little, base, step) {
        const raw = this.uint(size, bits, little, base, step);
        return raw >= 2 ** (bits - 1) ? raw - 2 ** bits : raw;
    }
    /** An unsigned integer of more than 53 bits. */
    ubig(size, bits, little, base, step) {
        const start = this.take(size, step);
        const shift = base === 128 ? 7n : 8n;
        let raw = 0n;
        for (let index = 0; index < size; index++) {
            const byte = this.bytes[little ? start + size - 1 - index : start + index];
            if (byte >= base)
                throw this.eighthBit(byte, step);
            raw = (raw << shift) | BigInt(byte);
        }
        if (raw >> BigInt(bits))
            throw this.padding(bits, step);
        return raw;
    }
    /** A signed integer of more than 53 bits. */
    sbig(size, bits, little, base, step) {
        return BigInt.asIntN(bits, this.ubig(size, bits, little, base, step));
    }
    eighthBit(byte, step) {
        return this.fault(step, "encoding", `${spelled([byte])} has its most significant bit set`);
    }
    padding(bits, step) {
        return this.fault(step, "value", `the bits above the lowest ${bits} have to be zero`);
    }
    bool(step) {
        const byte = this.u8(step);
        if (byte > 1) {
            throw this.fault(step, "value", `${spelled([byte])} is neither 00 (false) nor 01 (true)`);
        }
        return byte === 1;
    }
    // --- floats --------------------------------------------------------------------------------
    f32(little, step) {
        WORD.setUint32(0, little ? this.u32(step) : this.u32be(step));
        return WORD.getFloat32(0);
    }
    f64(little, step) {
        const at = this.take(8, step);
        for (let index = 0; index < 8; index++) {
            WORD.setUint8(little ? 7 - index : index, this.bytes[at + index]);
        }
        return WORD.getFloat64(0);
    }
    /** A float in bytes of 7 bits. */
    float7(bits, little, step) {
        const raw = this.ubig(Math.ceil(bits / 7), bits, little, 128, step);
        WORD.setBigUint64(0, raw << BigInt(64 - bits));
        return bits === 32 ? WORD.getFloat32(0) : WORD.getFloat64(0);
    }
    // --- values that are checked ---------------------------------------------------------------
    /** A value out of a closed enum. */
    one(value, values, step) {
        if (!values.includes(value)) {
            throw this.fault(step, "value", `${value} is not one of ${values.join(", ")}`);
        }
        return value;
    }
    /** A constant. */
    constant(value, due, step) {
        if (!same(value, due))
            throw this.fault(step, "value", `must be ${shown(due)}`);
        return due;
    }
    /** A number that earlier fields give, of elements or bytes. */
    count(number, least, greatest, by, step) {
        if (number < least || number > greatest) {
            throw this.fault(step, "size", `${by} counts ${least} to ${greatest}, not ${number}`);
        }
        return number;
    }
    /** The Fault of a selector without a case. */
    noCase(value, by, step) {
        return this.fault(step, "value", `there is no case for ${by} = ${value}`);
    }
    // --- bytes and texts -----------------------------------------------------------------------
    /** So many bytes, which are copied; with `sevenBit` each is at most 7F. */
    octets(size, sevenBit, step) {
        const at = this.take(size, step);
        const found = this.bytes.slice(at, at + size);
        if (sevenBit)
            for (const byte of found)
                if (byte > 0x7f)
                    throw this.eighthBit(byte, step);
        return found;
    }
    /** So many bytes as a text, one character each. */
    latin1(size, sevenBit, step) {
        const at = this.take(size, step);
        const { bytes } = this;
        let text = "";
        for (let place = at; place < at + size; place++) {
            const byte = bytes[place];
            if (sevenBit && byte > 0x7f)
                throw this.eighthBit(byte, step);
            text += String.fromCharCode(byte);
        }
        return text;
    }
    /** The number of bytes that are left. */
    rest(least, greatest, step) {
        const size = this.left;
        if (size < least || size > greatest) {
            throw this.fault(step, "size", `has ${size} bytes, and not ${least} to ${greatest}`);
        }
        return size;
    }
    /** Bytes in front of a terminator, which is taken, too. */
    until(byte, least, greatest, sevenBit, step) {
        const most = Math.min(this.left, greatest + 1);
        const found = this.bytes.subarray(this.at, this.at + most).indexOf(byte);
        if (most <= least || (found < 0 && most <= greatest)) {
            const missing = Math.max(1, least + 1 - most);
            throw this.fault(step, "size", `ends with ${spelled([byte])}, which is missing`, missing);
        }
        const size = found < 0 ? most : found;
        if (size < least || size > greatest) {
            throw this.fault(step, "size", `has ${size} bytes, and not ${least} to ${greatest}`);
        }
        const data = this.octets(size, sevenBit, step);
        this.at++;
        return data;
    }
    /** A text in front of a separator or of the end; with `leads` a separator stands in front. */
    between(separator, leads, allowed, least, greatest, step) {
        if (leads)
            this.separator(separator, step);
        const takesRest = allowed.includes(String.fromCharCode(separator));
        const found = takesRest ? -1 : this.bytes.subarray(this.at, this.end).indexOf(separator);
        const size = found < 0 ? this.left : found;
        if (size < least || size > greatest) {
            throw this.fault(step, "size", `needs ${least} to ${greatest} characters, not ${size}`);
        }
        for (let index = this.at; index < this.at + size; index++) {
            if (!allowed.includes(String.fromCharCode(this.bytes[index]))) {
                const wrong = spelled([this.bytes[index]]);
                throw this.fault(step, "value", `${wrong} is no character of it`);
            }
        }
        return this.latin1(size, false, step);
    }
    separator(separator, step) {
        if (this.at >= this.end)
            throw this.fault(step, "size", "the separator in front is missing");
        if (this.bytes[this.at] !== separator) {
            throw this.fault(step, "value", `${spelled([this.bytes[this.at]])} is not the separator`);
        }
        this.at++;
    }
    /** A text of a fixed size without its padding. */
    text(size, form, sevenBit, step) {
        const data = this.octets(size, sevenBit, step);
        let found = "";
        for (const byte of data) {
            const moved = byte - form.add;
            const character = moved >> form.shift;
            const isOne = moved >= 0 && character << form.shift === moved && character < 1 << form.bits;
            if (!isOne || (form.padding && !character)) {
                throw this.fault(step, "value", `${spelled([byte])} is no character of this text`);
            }
            found += String.fromCharCode(character);
        }
        let last = found.length;
        while (last && found.charCodeAt(last - 1) === form.padding)
            last--;
        return found.slice(0, last);
    }
    // --- regions, elements, bits ---------------------------------------------------------------
    /** Begin a region of so many bytes; what ends it is given to `close`. */
    open(size, step) {
        if (this.at + size > this.end)
            throw this.short(size, step);
        const outer = this.end;
        this.regions++;
        this.end = this.at + size;
        return outer;
    }
    /** End a region, of which nothing may be left. */
    close(outer, step) {
        if (this.left)
            throw this.fault(step, "size", `${this.left} bytes are left over`);
        this.regions--;
        this.end = outer;
    }
    /** The place of another element that takes what is left, -1 at its end; `here`: the one before. */
    next(here, index, least, greatest) {
        if (this.at === here) {
            throw this.fault("", "size", "an element of no bytes fills nothing");
        }
        if (this.left > 0) {
            this.count(index + 1, 0, greatest, "fill", "");
            return this.at;
        }
        this.count(index, least, greatest, "fill", "");
        return -1;
    }
    /** True if another element stands behind one that is not the last. */
    goesOn(isLast, index, least, greatest) {
        if (isLast)
            this.count(index, least, greatest, "fill", "");
        else
            this.count(index + 1, 0, greatest, "fill", "");
        return !isLast;
    }
    /** The number of elements in front of a tail. */
    elements(tail) {
        let left = this.left;
        if (tail.separator !== undefined) {
            left = 0;
            for (let index = this.at; index < this.end; index++) {
                if (this.bytes[index] === tail.separator)
                    left++;
            }
        }
        return Math.floor(Math.max(0, left - tail.least) / tail.element);
    }
    /** Take a run of packed bits as one integer. */
    run(size, little, step) {
        return this.ubig(size, 8 * size, little, 256, step);
    }
    /** Refuse bits of a run that belong to no number. */
    unused(run, mask, step) {
        if (run & mask)
            throw this.fault(step, "value", "the bits behind the last one have to be zero");
    }
    /** Refuse what is left of the payload. */
    finish() {
        if (this.left)
            throw this.fault("", "size", `${this.left} bytes too many`);
    }
}
/** The text of some bytes, one character each. */
export function latin1(bytes) {
    let text = "";
    for (const byte of bytes)
        text += String.fromCharCode(byte);
    return text;
}
/** True if two values of constants are equal. */
export function same(one, other) {
    if (one instanceof Uint8Array && other instanceof Uint8Array)
        return equal(one, other);
    if (Array.isArray(one) && Array.isArray(other)) {
        return one.length === other.length && one.every((item, index) => same(item, other[index]));
    }
    return one === other;
}
/** A value as errors show it. */
export function shown(value) {
    if (value instanceof Uint8Array)
        return spelled(value);
    if (Array.isArray(value))
        return `[${value.map(shown).join(", ")}]`;
    return typeof value === "string" ? JSON.stringify(value) : String(value);
}
