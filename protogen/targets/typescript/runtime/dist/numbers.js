/** Numbers of frames: integers of some bits in whole bytes, as digits, or as characters. */
import { EncodeError, Fault } from "./errors.js";
const BITS_OF_NUMBERS = 53;
/** The unsigned integer in bytes of 8 or 7 bits. */
function integerOf(bytes, at, size, little, sevenBit) {
    let raw = 0n;
    for (let index = 0; index < size; index++) {
        const byte = bytes[little ? at + size - 1 - index : at + index];
        if (sevenBit && byte > 0x7f)
            throw eighthBit(byte);
        raw = (raw << (sevenBit ? 7n : 8n)) | BigInt(byte);
    }
    return raw;
}
export function eighthBit(byte) {
    return new Fault("encoding", `${byte.toString(16)} has its most significant bit set`);
}
function store(raw, out, at, size, little, sevenBit) {
    let rest = raw;
    for (let index = 0; index < size; index++) {
        out[little ? at + index : at + size - 1 - index] = Number(rest & (sevenBit ? 0x7fn : 0xffn));
        rest >>= sevenBit ? 7n : 8n;
    }
}
/** An integer of `bits` bits from bit `low` on, of an unsigned integer of `size` bytes. */
class Unsigned {
    constructor(bits, size, little, sevenBit, low, isPart) {
        this.bits = bits;
        this.size = size;
        this.little = little;
        this.sevenBit = sevenBit;
        this.low = low;
        this.isPart = isPart;
        this.greatest = (1n << BigInt(bits)) - 1n;
        this.most = Number(this.greatest);
        this.isPlain = size <= 4 && !sevenBit && !isPart && bits === 8 * size;
    }
    decode(bytes, at) {
        if (this.isPlain) {
            let raw = 0;
            for (let index = 0; index < this.size; index++) {
                raw = raw * 256 + bytes[this.little ? at + this.size - 1 - index : at + index];
            }
            return raw;
        }
        const whole = integerOf(bytes, at, this.size, this.little, this.sevenBit);
        const raw = this.isPart ? (whole >> BigInt(this.low)) & this.greatest : whole;
        if (raw > this.greatest) {
            throw new Fault("value", `the bits above the lowest ${this.bits} have to be zero`);
        }
        return this.bits > BITS_OF_NUMBERS ? raw : Number(raw);
    }
    encode(value, out, at) {
        if (this.isPlain && typeof value === "number" && value >= 0 && value <= this.most) {
            const { size, little } = this;
            for (let index = 0, rest = value; index < size; index++, rest >>>= 8) {
                out[little ? at + index : at + size - 1 - index] = rest;
            }
            return;
        }
        const raw = BigInt(value);
        if (raw < 0n || raw > this.greatest) {
            throw new EncodeError("", `${value} is not in 0..${this.greatest}`);
        }
        store(raw << BigInt(this.low), out, at, this.size, this.little, this.sevenBit);
    }
    given(value) {
        const isWide = this.bits > BITS_OF_NUMBERS;
        if (typeof value === "bigint")
            return isWide ? value : Number(value);
        if (typeof value !== "number" || !Number.isInteger(value)) {
            throw new EncodeError("", `must be an integer, not ${String(value)}`);
        }
        return isWide ? BigInt(value) : value;
    }
}
/** An integer of 1 to 64 bits in as few whole bytes as hold it. */
export function number(bits, order = "little", sevenBit = false) {
    const size = Math.ceil(bits / (sevenBit ? 7 : 8));
    return new Unsigned(bits, size, order === "little", sevenBit, 0, false);
}
/** An integer that is some bits of another one. */
export function bitsNumber(bits, low, size, order = "little", sevenBit = false) {
    return new Unsigned(bits, size, order === "little", sevenBit, low, true);
}
/** An integer as so many digits, the most significant one first. */
class Digits {
    constructor(bits, alphabet, size) {
        this.bits = bits;
        this.alphabet = alphabet;
        this.size = size;
        this.isPlain = false;
        this.values = new Map();
        alphabet.forEach((character, value) => this.values.set(character, BigInt(value)));
    }
    decode(bytes, at) {
        let raw = 0n;
        for (let index = 0; index < this.size; index++) {
            const digit = this.values.get(bytes[at + index]);
            if (digit === undefined)
                throw new Fault("value", "a character is no digit here");
            raw = raw * BigInt(this.alphabet.length) + digit;
        }
        if (raw >> BigInt(this.bits))
            throw new Fault("value", `${raw} does not fit ${this.bits} bits`);
        return this.bits > BITS_OF_NUMBERS ? raw : Number(raw);
    }
    encode(value, out, at) {
        let rest = BigInt(value);
        const base = BigInt(this.alphabet.length);
        if (rest < 0n || rest >> BigInt(this.bits)) {
            throw new EncodeError("", `${value} does not fit ${this.bits} bits`);
        }
        for (let index = this.size - 1; index >= 0; index--) {
            out[at + index] = this.alphabet[Number(rest % base)];
            rest /= base;
        }
        if (rest)
            throw new EncodeError("", `${value} has more than ${this.size} digits`);
    }
    given(value) {
        return new Unsigned(this.bits, this.size, false, false, 0, false).given(value);
    }
}
/** An integer as so many digits out of `alphabet`, the most significant one first. */
export function digits(bits, alphabet, size) {
    return new Digits(bits, alphabet, size);
}
/** A text of up to `size` characters, which zeros fill up. */
class Characters {
    constructor(size, sevenBit) {
        this.size = size;
        this.sevenBit = sevenBit;
        this.isPlain = false;
    }
    decode(bytes, at) {
        let text = "";
        for (let index = 0; index < this.size; index++) {
            const byte = bytes[at + index];
            if (this.sevenBit && byte > 0x7f)
                throw eighthBit(byte);
            text += String.fromCharCode(byte);
        }
        return text.replace(/\0+$/, "");
    }
    encode(value, out, at) {
        const text = String(value);
        for (let index = 0; index < this.size; index++) {
            out[at + index] = index < text.length ? text.charCodeAt(index) : 0;
        }
    }
    given(value) {
        if (typeof value !== "string") {
            throw new EncodeError("", `must be a text of ${this.size} characters, not ${String(value)}`);
        }
        const greatest = this.sevenBit ? "\x7f" : "\xff";
        if ([...value].some((character) => character > greatest)) {
            throw new EncodeError("", `"${value}" has a character that is not one byte`);
        }
        if (value.length > this.size) {
            const problem = `"${value}" has ${value.length} characters, and ${this.size} fit`;
            throw new EncodeError("", problem);
        }
        return value.replace(/\0+$/, "");
    }
}
/** A text of up to `size` characters, which zeros fill up. */
export function characters(size, sevenBit = false) {
    return new Characters(size, sevenBit);
}
