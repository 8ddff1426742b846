/** The places of a frame's parts, and what makes those that are not always the same. */
import { concatenated } from "./bytes.js";
import { dueOf } from "./candidate.js";
import { EncodeError } from "./errors.js";
import { numbersOf } from "./sender.js";
function spotIn({ offset, moves }, payload) {
    return offset + moves * payload;
}
/** The error of a part, whose number does not take its value. */
export function inside(error, name) {
    return error instanceof EncodeError ? new EncodeError(name, error.problem) : error;
}
/** Write the number of a part. Throws an EncodeError. */
export function put(number, value, out, at, name) {
    try {
        number.encode(value, out, at);
    }
    catch (error) {
        throw inside(error, name);
    }
}
/**
 * What gives a value: a slot, a length, or anything else.
 *
 * They are of one class, as a machine is faster where it knows what it calls.
 */
class Source {
    constructor(slot, length = null, other = null) {
        this.slot = slot;
        this.length = length;
        this.other = other;
    }
    value(content, payload, values) {
        const { slot, length } = this;
        if (slot >= 0)
            return values[slot];
        return length ? length.of(payload) : this.other(content, payload, values);
    }
}
function other(value) {
    return new Source(-1, null, value);
}
/** A length in a layout: so many bytes more than the payload. */
class Length {
    constructor(part, isEmpty) {
        this.part = part;
        this.base = part.base + (isEmpty ? 0 : part.optional);
    }
    /** Its value in a frame whose payload has so many bytes. Throws an EncodeError. */
    of(payload) {
        const value = this.base + payload;
        const { name, least, greatest } = this.part;
        if (value >= least && value <= greatest)
            return value;
        throw new EncodeError("payload", `makes ${name} ${value}, not in ${least}..${greatest}`);
    }
}
/** A part that is put into each frame. */
class Step {
    constructor(name, number, source, spot) {
        this.name = name;
        this.number = number;
        this.source = source;
        this.spot = spot;
    }
    make(content, payload, values) {
        const value = this.source.value(content, payload, values);
        put(this.number, value, content, spotIn(this.spot, payload), this.name);
    }
}
/** How frames of a sender are put together, those with a payload or those with an empty one. */
export class Layout {
    constructor(sender, isEmpty) {
        this.sender = sender;
        this.isEmpty = isEmpty;
        this.steps = [];
        this.isPlanned = [];
        const { frame } = sender;
        const { parts, headSize, end } = frame;
        const offsets = isEmpty ? sender.offsetsEmpty : sender.offsets;
        this.spots = offsets.map((offset, index) => ({
            offset,
            moves: index > frame.payloadIndex ? 1 : 0,
        }));
        const fixed = concatenated([new Uint8Array(offsets[parts.length]), end]);
        this.head = fixed.subarray(0, headSize);
        this.tail = fixed.subarray(headSize);
        this.region = this.regionOf();
        this.told = sender.toldLength && new Length(sender.toldLength, isEmpty);
        parts.forEach((part, index) => {
            if (part.kind === "literal" && !this.isAbsent(part))
                fixed.set(part.bytes, offsets[index]);
            else
                this.plan(index);
        });
    }
    /** Bytes in front of the payload and behind it, before any stuffing. */
    get size() {
        return this.head.length + this.tail.length;
    }
    /** The frame around the payload that was written. Throws an EncodeError. */
    wire(writer, payload, values) {
        const { head, tail, region, steps } = this;
        const { frame, length } = this.sender;
        if (payload > frame.greatestPayload && (length !== null || frame.isBounded)) {
            const problem = `has ${payload} bytes, at most ${frame.greatestPayload} fit`;
            throw new EncodeError("payload", problem);
        }
        const behind = head.length + payload;
        writer.size = behind;
        writer.room(tail.length);
        const { bytes } = writer;
        this.told?.of(payload);
        for (let index = 0; index < head.length; index++)
            bytes[index] = head[index];
        for (let index = 0; index < tail.length; index++)
            bytes[behind + index] = tail[index];
        for (let index = 0; index < steps.length; index++) {
            steps[index].make(bytes, payload, values);
        }
        if (!region)
            return writer.taken();
        const [from, to] = region;
        return frame.transparency.put(bytes, writer.size, spotIn(from, payload), spotIn(to, payload));
    }
    isAbsent(part) {
        return this.isEmpty && part.isOptional === true;
    }
    regionOf() {
        const { parts, firstStuffed, lastStuffed, transparency } = this.sender.frame;
        if (!transparency)
            return null;
        const stuffed = parts.slice(firstStuffed, lastStuffed + 1);
        if (this.isEmpty && stuffed.every((part) => this.isAbsent(part)))
            return null;
        return [this.spots[firstStuffed], this.spots[lastStuffed + 1]];
    }
    spot(place) {
        if (!place.isTail)
            return { offset: place.offset, moves: 0 };
        const absent = this.isEmpty ? place.absent : 0;
        return { offset: this.sender.frame.headSize + place.offset - absent, moves: 1 };
    }
    // --- steps, each behind those whose bytes it needs ------------------------------------------
    plan(index) {
        const part = this.sender.frame.parts[index];
        if (this.isPlanned[index] || this.isAbsent(part))
            return;
        this.isPlanned[index] = true;
        if (part.kind === "literal" || part.kind === "payload")
            return;
        const [{ name, number }, source] = this.numbered(part);
        this.steps.push(new Step(name, number, source, this.spots[index]));
    }
    /** Plan all parts of a run of content. */
    planRun(from, to) {
        const payload = this.isEmpty ? 0 : 1;
        const [first, end] = [spotIn(from, payload), spotIn(to, payload)];
        for (let index = 0; index + 1 < this.spots.length; index++) {
            const isIn = spotIn(this.spots[index], payload) < end;
            if (isIn && spotIn(this.spots[index + 1], payload) > first)
                this.plan(index);
        }
    }
    /** A part that is a number, and what gives its value. */
    numbered(part) {
        if (part.kind === "bits")
            return [part, this.bits(part)];
        if (part.kind === "number")
            return [part.part, this.slot(part.part.slot)];
        const sum = this.sender.frame.sums[part.sum];
        return [sum, this.sum(sum)];
    }
    /** The value of a slot: one that is known, or a length. */
    slot(slot) {
        const numbers = numbersOf(this.sender.frame.parts);
        const length = numbers.find((item) => item.kind === "length" && item.slot === slot);
        return length?.kind === "length" ? this.length(length) : new Source(slot);
    }
    length(part) {
        const length = new Length(part, this.isEmpty);
        const more = part.overWire ? this.stuffing() : null;
        if (!more)
            return new Source(-1, length);
        return other((content, payload) => length.of(payload + more(content, payload)));
    }
    /** Bytes that stuffing adds; null where nothing is stuffed. */
    stuffing() {
        const { region } = this;
        if (!region)
            return null;
        const [from, to] = region;
        this.planRun(from, to);
        return (content, payload) => {
            const plain = content.slice(spotIn(from, payload), spotIn(to, payload));
            return this.sender.frame.transparency.encode(plain).length - plain.length;
        };
    }
    bits(part) {
        const scratch = new Uint8Array(part.size);
        const items = [
            ...part.members.map((item) => [item, this.slot(item.slot)]),
            ...part.sums.map((index) => {
                const sum = this.sender.frame.sums[index];
                return [sum, this.sum(sum)];
            }),
            ...part.mirrors.map((item) => [item, this.mirror(item)]),
        ];
        return other((content, payload, values) => {
            let joined = part.fixed;
            for (const [{ number, name }, source] of items) {
                put(number, source.value(content, payload, values), scratch, 0, name);
                joined |= BigInt(part.number.decode(scratch, 0));
            }
            return joined;
        });
    }
    mirror({ of, flips }) {
        const found = this.slot(of);
        return other((content, payload, values) => Number(BigInt(found.value(content, payload, values)) ^ flips));
    }
    // --- checksums -----------------------------------------------------------------------------
    sum(sum) {
        const { algorithm, covers } = sum;
        const pieces = covers.map((covered) => this.covered(covered, sum.name));
        return other((content, payload, values) => {
            const joined = concatenated(pieces.map((piece) => piece(content, payload, values)));
            return dueOf(sum, algorithm.compute(joined, 0, joined.length));
        });
    }
    /** The bounds of a run of content, all of whose parts are planned. */
    run(covered) {
        const run = [this.spot(covered.from), this.spot(covered.to)];
        this.planRun(...run);
        return run;
    }
    covered(covered, name) {
        if ("bytes" in covered)
            return () => covered.bytes;
        if ("virtual" in covered) {
            return (_content, _payload, values) => this.virtual(covered.virtual, values, name);
        }
        const [from, to] = this.run(covered);
        return (content, payload) => {
            const plain = content.slice(spotIn(from, payload), spotIn(to, payload));
            return covered.stuffed ? this.sender.frame.transparency.encode(plain) : plain;
        };
    }
    virtual(index, values, by) {
        const bytes = this.sender.virtual(index, values);
        if (bytes)
            return bytes;
        const problem = `has no value for an unknown identity, and ${by} covers it`;
        throw new EncodeError(this.sender.frame.virtual[index].name, problem);
    }
}
