/** Frames from their parts. */
import { concatenated, equal, hasHighBit } from "./bytes.js";
import { Cut, dueOf, verdictOn } from "./candidate.js";
import { mayBe } from "./content.js";
import { EncodeError } from "./errors.js";
import { areAmong, at, ownOf } from "./plan.js";
import { numbersOf, payloadOf, writerOf } from "./sender.js";
/** The frame of a message. Throws an EncodeError. */
export function frameOf(sender, message, value, given, strict) {
    const { headSize } = sender.frame;
    const made = payloadOf(message, value, strict, headSize);
    const size = sender.trimmed(made.bytes, headSize, made.size - headSize);
    const parts = message.held.length ? withHeld(given, made.held) : given;
    const values = new Array(sender.frame.slots);
    identityOf(sender, message, parts, values);
    return encodeFrame(sender, made, size, parts, values, strict);
}
/** The parts that callers give, and those that are fields. Throws an EncodeError if they differ. */
function withHeld(given, held) {
    for (const [name, value] of Object.entries(held)) {
        const own = ownOf(given, name) ?? null;
        // A number may be given for a bigint, and a bigint for a number.
        const isSame = (typeof own === "number" || typeof own === "bigint") && own == value;
        if (own !== null && !isSame) {
            throw new EncodeError(name, `is ${value}, as the message says, and not ${String(own)}`);
        }
    }
    return { ...given, ...held };
}
/** Set the identity of a message: what callers give, or the first one. */
function identityOf(sender, message, given, values) {
    for (let index = 0; index < sender.identityParts.length; index++) {
        const { name, slot, number } = sender.identityParts[index];
        const runs = message.identities[index];
        const own = ownOf(given, name);
        values[slot] = runs[0][0];
        if (own === undefined || own === null)
            continue;
        const chosen = givenTo(number, own, name);
        if (!areAmong([runs], [chosen])) {
            throw new EncodeError(name, `${chosen} is not an identity of ${message.name}`);
        }
        values[slot] = chosen;
    }
}
/** The frame of an unknown message, whose identity is given. Throws an EncodeError. */
export function unknownFrameOf(sender, payload, given) {
    const values = new Array(sender.frame.slots);
    for (const { name, slot, number } of sender.identityParts) {
        values[slot] = givenTo(number, ownOf(given, name), name);
    }
    const writer = writerOf(false, sender.frame.headSize);
    const place = writer.room(payload.length);
    writer.bytes.set(payload, place);
    return encodeFrame(sender, writer, payload.length, given, values, false);
}
function givenTo(number, value, name) {
    if (!number) {
        if (typeof value === "number" && Number.isInteger(value))
            return value;
        throw new EncodeError(name, `must be an integer, not ${String(value)}`);
    }
    try {
        return number.given(value);
    }
    catch (error) {
        throw inside(error, name);
    }
}
function inside(error, name) {
    return error instanceof EncodeError ? new EncodeError(name, error.problem) : error;
}
function encodeFrame(sender, writer, size, given, values, strict) {
    const { valueParts } = sender;
    for (const name of Object.keys(given)) {
        if (!sender.given.has(name) && given[name] !== undefined && given[name] !== null) {
            throw new EncodeError(name, "there is no such part");
        }
    }
    for (const part of valueParts)
        values[part.slot] = valueOf(part, ownOf(given, part.name), strict);
    const wire = new Assembly(sender, values, writer, size).wire();
    const { frame } = sender;
    if (frame.isBounded && wire.length > frame.greatest) {
        const problem = `makes a frame of ${wire.length} bytes, at most ${frame.greatest} are allowed`;
        throw new EncodeError("payload", problem);
    }
    if (frame.cutAmbiguous || !sender.group(values)) {
        const payload = writer.bytes.slice(frame.headSize, frame.headSize + size);
        checkCut(sender, wire, payload, values);
    }
    return wire;
}
function valueOf(part, given, strict) {
    const isGiven = given !== undefined && given !== null;
    if (!isGiven && part.default === null) {
        const advice = part.isCounter ? ", or use an Encoder, which counts" : "";
        throw new EncodeError(part.name, `the value is missing; give it as a part${advice}`);
    }
    const value = isGiven ? givenTo(part.number, given, part.name) : part.default;
    if (!strict && !part.isHeld)
        return value;
    if (strict && typeof given === "string" && /[^\0-\x7f]/.test(given)) {
        throw new EncodeError(part.name, `"${given}" has a character that is not ASCII`);
    }
    if (!mayBe(part, value))
        throw new EncodeError(part.name, `it can't be ${value}`);
    return value;
}
/** Throw an EncodeError unless a decoder takes exactly these bytes for the frame. */
function checkCut(sender, wire, payload, values) {
    const told = [...values];
    sender.tellSize(told, payload.length);
    const [verdict] = verdictOn(sender, wire, told);
    if (verdict.size < wire.length) {
        const problem = `a decoder would end the frame behind ${verdict.size} of its bytes`;
        throw new EncodeError("payload", problem);
    }
    if (!(verdict instanceof Cut) || !equal(verdict.payload, payload)) {
        throw new EncodeError("payload", "a decoder would not find it in the frame");
    }
}
/** The bytes of one frame's parts. A checksum or a length is worked out when it is needed. */
class Assembly {
    constructor(sender, values, writer, payload) {
        this.sender = sender;
        this.values = values;
        this.payload = payload;
        const { offsets, offsetsEmpty, frame } = sender;
        this.offsets = payload ? offsets : offsetsEmpty;
        this.isMade = new Array(frame.parts.length);
        writer.room(frame.tailSize);
        this.content = writer.bytes;
    }
    /** Where a part begins; the part behind the last one, where the content ends. */
    place(index) {
        const isBehind = index > this.sender.frame.payloadIndex;
        return this.offsets[index] + (isBehind ? this.payload : 0);
    }
    wire() {
        const { frame } = this.sender;
        const isHeld = this.sender.length !== null || frame.isBounded;
        if (isHeld && this.payload > frame.greatestPayload) {
            const problem = `has ${this.payload} bytes, at most ${frame.greatestPayload} fit`;
            throw new EncodeError("payload", problem);
        }
        const { headSize, end } = frame;
        if (frame.sevenBit && hasHighBit(this.content, headSize, headSize + this.payload)) {
            throw new EncodeError("payload", "a byte has its most significant bit set");
        }
        if (this.sender.toldLength)
            this.length(this.sender.toldLength);
        const size = this.place(frame.parts.length);
        this.complete(0, size);
        const region = this.region();
        return region
            ? frame.transparency.put(this.content, size, ...region, end)
            : concatenated([this.content.slice(0, size), end]);
    }
    /** Bounds of what is stuffed; null where nothing is. */
    region() {
        const { parts, firstStuffed, lastStuffed, transparency } = this.sender.frame;
        if (!transparency)
            return null;
        const stuffed = this.payload ? [] : parts.slice(firstStuffed, lastStuffed + 1);
        if (!this.payload && stuffed.every((part) => part.isOptional === true))
            return null;
        return [this.place(firstStuffed), this.place(lastStuffed + 1)];
    }
    /** Make all parts of some content. */
    complete(from, to) {
        const { parts } = this.sender.frame;
        for (let index = 0; index < parts.length; index++) {
            if (this.isMade[index])
                continue;
            const start = this.place(index);
            if (start >= to || this.place(index + 1) <= from)
                continue;
            this.isMade[index] = true;
            this.make(parts[index], start);
        }
    }
    /** Content, all of whose parts are made. */
    bytes(from, to) {
        this.complete(from, to);
        return this.content.slice(from, to);
    }
    make(part, place) {
        if (part.kind === "literal") {
            for (let index = 0; index < part.size; index++)
                this.content[place + index] = part.bytes[index];
        }
        else if (part.kind === "bits")
            this.makeBits(part, place);
        else if (part.kind === "sum") {
            const { number, name } = this.sender.frame.sums[part.sum];
            this.put(number, this.sum(part.sum), place, name);
        }
        else if (part.kind === "number") {
            const { part: item } = part;
            const value = item.kind === "length" ? this.length(item) : this.values[item.slot];
            this.put(item.number, value, place, item.name);
        }
    }
    put(number, value, place, name) {
        try {
            number.encode(value, this.content, place);
        }
        catch (error) {
            throw inside(error, name);
        }
    }
    makeBits(part, place) {
        let joined = part.fixed;
        const scratch = new Uint8Array(part.size);
        const add = (number, value, name) => {
            try {
                number.encode(value, scratch, 0);
            }
            catch (error) {
                throw inside(error, name);
            }
            joined |= BigInt(part.number.decode(scratch, 0));
        };
        for (const item of part.members) {
            add(item.number, this.numberAt(item.slot), item.name);
        }
        for (const index of part.sums) {
            const item = this.sender.frame.sums[index];
            add(item.number, this.sum(index), item.name);
        }
        for (const item of part.mirrors) {
            const flipped = BigInt(this.numberAt(item.of)) ^ item.flips;
            add(item.number, Number(flipped), item.name);
        }
        this.put(part.number, joined, place, part.name);
    }
    /** The number of a slot: one that is given, or a length. */
    numberAt(slot) {
        const found = this.values[slot];
        if (found !== undefined)
            return found;
        const lengths = numbersOf(this.sender.frame.parts).filter((item) => item.kind === "length");
        return this.length(lengths.find((item) => item.slot === slot));
    }
    length(part) {
        const size = this.payload;
        let value = part.base + (size ? size + part.optional : 0);
        const region = part.overWire ? this.region() : null;
        if (region) {
            const plain = this.bytes(...region);
            value += this.sender.frame.transparency.encode(plain).length - plain.length;
        }
        if (value < part.least || value > part.greatest) {
            const problem = `makes ${part.name} ${value}, not in ${part.least}..${part.greatest}`;
            throw new EncodeError("payload", problem);
        }
        return value;
    }
    sum(index) {
        const sum = this.sender.frame.sums[index];
        const [first] = sum.covers;
        if (sum.covers.length === 1 && first && "from" in first && !first.stuffed) {
            const { headSize } = this.sender.frame;
            const from = at(first.from, headSize, this.payload);
            const to = at(first.to, headSize, this.payload);
            this.complete(from, to);
            return dueOf(sum, sum.algorithm.compute(this.content, from, to));
        }
        const pieces = sum.covers.map((covered) => this.covered(covered, sum.name));
        const joined = concatenated(pieces);
        return dueOf(sum, sum.algorithm.compute(joined, 0, joined.length));
    }
    covered(covered, name) {
        if ("bytes" in covered)
            return covered.bytes;
        if ("virtual" in covered) {
            const bytes = this.sender.virtual(covered.virtual, this.values);
            if (bytes)
                return bytes;
            const part = this.sender.frame.virtual[covered.virtual];
            const problem = `has no value for an unknown identity, and ${name} covers it`;
            throw new EncodeError(part.name, problem);
        }
        const { headSize } = this.sender.frame;
        const size = this.payload;
        const from = at(covered.from, headSize, size);
        const plain = this.bytes(from, at(covered.to, headSize, size));
        return covered.stuffed ? this.sender.frame.transparency.encode(plain) : plain;
    }
}
