/** Frames from their parts: what is always the same, and what each frame has anew. */
import { equal, hasHighBit } from "./bytes.js";
import { Cut, verdictOn } from "./candidate.js";
import { EncodeError } from "./errors.js";
import { GivenPart, givenTo } from "./given.js";
import { Layout } from "./layout.js";
import { areAmong, ownOf } from "./plan.js";
import { checkSize, writerOf } from "./sender.js";
/** What makes the frames of a sender, one after another. */
class Assembly {
    constructor(sender) {
        this.sender = sender;
        this.makers = new Map();
        this.full = new Layout(sender, false);
        this.empty = new Layout(sender, true);
        this.values = new Array(sender.frame.slots).fill(undefined);
        this.parts = sender.valueParts.map((part) => new GivenPart(part));
    }
    maker(message) {
        let found = this.makers.get(message);
        if (!found)
            this.makers.set(message, (found = new FrameMaker(this, message)));
        return found;
    }
    /**
     * Set the values of a frame to what callers give, and to what is usual where they give nothing.
     *
     * True if they give an identity. Throws an EncodeError.
     */
    take(identity, given, strict, counts) {
        const { values, parts } = this;
        const { identityParts } = this.sender;
        for (let index = 0; index < identityParts.length; index++) {
            values[identityParts[index].slot] = identity[index];
        }
        let left = 0;
        for (const _name in given)
            left++;
        let missing = null;
        for (let index = 0; index < parts.length; index++) {
            const part = parts[index];
            const own = part.own(given);
            if (own !== undefined && own !== null) {
                values[part.slot] = part.given(own, strict);
                left--;
            }
            else {
                const usual = part.usual(counts);
                values[part.slot] = usual ?? undefined;
                if (usual === null)
                    missing ?? (missing = part);
            }
        }
        const isOther = left !== 0 && this.takeIdentity(given);
        if (missing)
            throw missing.error();
        return isOther;
    }
    /** The same of what callers give of the identity; nothing else is left. */
    takeIdentity(given) {
        let isGiven = false;
        for (const [name, own] of Object.entries(given)) {
            if (own === undefined || own === null)
                continue;
            if (this.parts.some((part) => part.name === name))
                continue;
            const part = this.sender.identityParts.find((item) => item.name === name);
            if (!part)
                throw new EncodeError(name, "there is no such part");
            this.values[part.slot] = givenTo(part.number, own, name);
            isGiven = true;
        }
        return isGiven;
    }
    /** The frame around a payload of so many bytes, which was written. Throws an EncodeError. */
    wire(writer, size) {
        const { frame } = this.sender;
        const wire = (size ? this.full : this.empty).wire(writer, size, this.values);
        if (frame.isBounded && wire.length > frame.greatest) {
            const { greatest } = frame;
            const problem = `makes a frame of ${wire.length} bytes, at most ${greatest} are allowed`;
            throw new EncodeError("payload", problem);
        }
        return wire;
    }
    /** Throw an EncodeError unless a decoder takes exactly these bytes for the frame. */
    check(wire, payload) {
        const told = [...this.values];
        this.sender.tellSize(told, payload.length);
        const [verdict] = verdictOn(this.sender, wire, told);
        if (verdict.size < wire.length) {
            const problem = `a decoder would end the frame behind ${verdict.size} of its bytes`;
            throw new EncodeError("payload", problem);
        }
        if (!(verdict instanceof Cut) || !equal(verdict.payload, payload)) {
            throw new EncodeError("payload", "a decoder would not find it in the frame");
        }
    }
}
/** Behind every frame. It is no Infinity, which takes longer to compare with. */
const FAR = 0x3fffffff;
/** Makes the frames of a message. */
export class FrameMaker {
    constructor(assembly, message) {
        this.assembly = assembly;
        this.message = message;
        const { sender, values } = assembly;
        const { least, greatest } = message.sizes;
        const { transparency, kept, cutAmbiguous } = sender.frame;
        this.values = message.identities.map((runs) => runs[0][0]);
        sender.identityParts.forEach(({ slot }, index) => (values[slot] = this.values[index]));
        this.isDoubtful = cutAmbiguous || !sender.group(values);
        const isFixed = least === greatest && !transparency && kept === null;
        this.size = isFixed ? least + (least ? assembly.full : assembly.empty).size : 0;
        this.put = this.isDoubtful || message.held.length ? null : sender.frame.put;
        this.headSize = sender.frame.headSize;
        this.end = least === greatest ? this.headSize + least : -1;
        this.kept = kept === null ? FAR : this.headSize + kept;
        const { length } = sender;
        this.base = length ? length.base : 0;
        this.least = length ? length.least : 0;
        this.greatest = length ? Math.min(length.greatest, this.base + sender.frame.greatestPayload) : 0;
    }
    get sender() {
        return this.assembly.sender;
    }
    /**
     * The frame of a message with the values of parts that callers give.
     *
     * Counters that they do not give are those of `counts`, which go on. Throws an EncodeError.
     */
    make(value, given, strict, counts = null) {
        const { assembly, headSize, put } = this;
        const writer = writerOf(strict, headSize, this.size);
        this.message.write(writer, value);
        if (writer.size !== this.end)
            checkSize(this.message, writer.size - headSize);
        while (writer.size > this.kept && writer.bytes[writer.size - 1] === 0)
            writer.size--;
        const size = writer.size - headSize;
        const found = put && put(this, writer, given, counts);
        const wire = found ?? this.described(writer, size, given, strict, counts);
        if (counts)
            for (const part of assembly.parts)
                part.count(given, counts);
        return wire;
    }
    /** The frame around a payload, by the description of the frame. Throws an EncodeError. */
    described(writer, size, given, strict, counts) {
        const { assembly, headSize, message } = this;
        const parts = message.held.length ? withHeld(given, writer.held) : given;
        let isDoubtful = this.isDoubtful;
        if (assembly.take(this.values, parts, strict, counts))
            isDoubtful = this.checkIdentity();
        const wire = assembly.wire(writer, size);
        if (isDoubtful)
            assembly.check(wire, writer.bytes.slice(headSize, headSize + size));
        return wire;
    }
    // --- what printed functions ask -----------------------------------------------------------------
    /** An identity. */
    identity(index) {
        return this.values[index];
    }
    /** The length of a frame whose payload ends there; -1 where it can't be. */
    length(end) {
        const value = this.base + end - this.headSize;
        return value >= this.least && value <= this.greatest ? value : -1;
    }
    /** The value of a part where callers give none. */
    usual(index, counts) {
        return this.assembly.parts[index].usual(counts);
    }
    /** A value that is a number in these bounds; -1 of another one. */
    number(value, least, greatest) {
        const isIn = typeof value === "number" && value >= least && value <= greatest;
        return isIn && Number.isInteger(value) ? value : -1;
    }
    /** The checksum of some bytes. */
    sum(bytes, from, to) {
        return this.assembly.sender.frame.sums[0].algorithm.compute(bytes, from, to);
    }
    /** The frame of content whose payload ends there, with its region stuffed. */
    stuffed(writer, end) {
        const { frame, offsets } = this.assembly.sender;
        const behind = offsets[frame.lastStuffed + 1] - frame.headSize;
        const from = offsets[frame.firstStuffed];
        return frame.transparency.put(writer.bytes, writer.size, from, end + behind);
    }
    /** True if a decoder could take a frame of a given identity for another one. */
    checkIdentity() {
        const { sender, values } = this.assembly;
        sender.identityParts.forEach(({ name, slot }, index) => {
            const value = values[slot];
            if (areAmong([this.message.identities[index]], [value]))
                return;
            throw new EncodeError(name, `${value} is not an identity of ${this.message.name}`);
        });
        return sender.frame.cutAmbiguous || !sender.group(values);
    }
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
const ASSEMBLIES = /* @__PURE__ */ new WeakMap();
function assemblyOf(sender) {
    let found = ASSEMBLIES.get(sender);
    if (!found)
        ASSEMBLIES.set(sender, (found = new Assembly(sender)));
    return found;
}
/** What makes the frames of a message that the sender sends. */
export function makerOf(sender, message) {
    return assemblyOf(sender).maker(message);
}
/** The frame of an unknown message, whose identity is given. Throws an EncodeError. */
export function unknownFrameOf(sender, payload, given) {
    const assembly = assemblyOf(sender);
    const { headSize } = sender.frame;
    assembly.take([], given, false, null);
    for (const { name, slot, number } of sender.identityParts) {
        if (assembly.values[slot] === undefined)
            givenTo(number, undefined, name);
    }
    if (sender.frame.sevenBit && hasHighBit(payload, 0, payload.length)) {
        throw new EncodeError("payload", "a byte has its most significant bit set");
    }
    const writer = writerOf(false, headSize);
    const place = writer.room(payload.length);
    writer.bytes.set(payload, place);
    const wire = assembly.wire(writer, payload.length);
    if (sender.frame.cutAmbiguous || !sender.group(assembly.values))
        assembly.check(wire, payload);
    return wire;
}
