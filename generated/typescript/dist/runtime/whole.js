/**
 * Frames that are plainly in order, taken as they come in, without a candidate.
 *
 * Whatever is not plain is left to a candidate, which looks at it byte by byte and knows the reason.
 * So what is waited for here, a candidate would wait for as well.
 */
import { marksOf } from "./at_once.js";
import { concatenated, equal, hasHighBit, NO_BYTES, standsAt } from "./bytes.js";
import { Cut, sumIsRight } from "./candidate.js";
import { mayBe } from "./content.js";
import { Fault } from "./errors.js";
import { framed, Framed } from "./events.js";
import { at as placeAt, holds } from "./plan.js";
import { Reader } from "./reader.js";
import { numbersOf } from "./sender.js";
/** Takes frames of one sender, as far as they have come in. */
export class WholeFrames {
    constructor(sender) {
        this.sender = sender;
        /** True if all that has come of the frame is in order, and more has to come. */
        this.isWaiting = false;
        this.head = [];
        this.reader = new Reader(NO_BYTES);
        // Of the frame that is taken:
        /** Bytes on the wire that are in order. */
        this.place = 0;
        /** Bytes of content that are there. */
        this.filled = 0;
        /** Bytes on the wire in which nothing stands that would end the frame. */
        this.clear = 0;
        /** Parts in front of the payload that are in order. */
        this.passed = 0;
        /** Bytes of the payload; -1 while that is not known. */
        this.payload = -1;
        this.unstuffer = null;
        this.values = [];
        const { frame } = sender;
        this.frame = frame;
        this.transparency = frame.transparency;
        let offset = 0;
        for (const part of frame.parts.slice(0, frame.payloadIndex)) {
            const literal = part.kind === "literal" ? part.bytes : NO_BYTES;
            const number = part.kind === "number" ? part.part : null;
            const end = offset + part.size;
            const slot = number?.slot ?? -1;
            const isByte = number?.kind !== "length" && part.size === 1 && isAny(number);
            if (frame.startBytes.length < end) {
                this.head.push({ offset, end, literal, number, slot, isByte });
            }
            offset = end;
        }
        const inFront = frame.parts.slice(0, Math.max(0, frame.firstStuffed));
        this.before = inFront.reduce((size, part) => size + part.size, 0);
        this.scratch = new Uint8Array(frame.greatest + 1);
        this.scratch.set(frame.startBytes);
        this.found = Math.min(frame.startBytes.length, this.before);
        this.runs = frame.sums.map(({ covers: [first, ...more] }) => first && "from" in first && !more.length ? first : undefined);
        this.marks = marksOf(sender);
        if (frame.sevenBit)
            this.marks.fill(1, 128);
    }
    /** What takes the frames of a sender; null where the frame does not allow that. */
    static of(sender) {
        const { frame } = sender;
        const isPlain = frame.parts.every((part, index) => part.kind !== "bits" && (index < frame.payloadIndex || !part.isOptional));
        const isTold = frame.told.length > 0 || frame.virtual.length > 0;
        const isOnce = numbersOf(frame.parts).every((part) => part.kind !== "length" || !part.isFurther);
        const allows = frame.takesWhole && isPlain && isOnce && !isTold && !frame.sharesDelimiter;
        return allows && !sender.hasWireSum ? new WholeFrames(sender) : null;
    }
    /** Begin another frame. */
    begin() {
        this.place = this.filled = this.found;
        this.passed = 0;
        this.clear = this.sender.startSize;
        this.payload = -1;
        this.unstuffer = this.transparency?.decoder() ?? null;
    }
    /** The event of the frame there; null: it is not all there yet, or a candidate has to look. */
    take(source, size, at) {
        const { data } = source;
        this.isWaiting = false;
        try {
            const end = this.reach(data, size, at);
            if (end < 0) {
                this.isWaiting && (this.isWaiting = size - at < this.frame.givenUpAt);
                return null;
            }
            return end - at > this.frame.givenUpAt ? null : this.event(source, at, end);
        }
        catch (error) {
            this.isWaiting = false;
            if (error instanceof Fault)
                return null;
            throw error;
        }
    }
    /** The place behind the frame; -1 where it is not all there, or not plainly one. */
    reach(data, size, at) {
        const { frame } = this.sender;
        const { headSize } = frame;
        if (frame.start === "after_end" && standsAt(data, size, at, frame.end))
            return -1;
        if (this.payload < 0) {
            const isThere = this.fill(data, size, at, headSize);
            if (this.transparency ? !this.readHead(this.scratch, 0) : !this.readHead(data, at))
                return -1;
            if (!isThere)
                return this.wait(data, size, at);
            this.payload = this.payloadSize();
            if (this.payload < 0)
                return this.reachEnd(data, size, at);
        }
        const due = headSize + this.payload + this.sender.tailSize(this.payload);
        if (!this.fill(data, size, at, due))
            return this.wait(data, size, at);
        return this.filled === due ? this.behind(data, size, at) : -1;
    }
    /** The same where the end has to tell the size. */
    reachEnd(data, size, at) {
        const { end, endIsUnique, markSize, behindRegion, greatest } = this.frame;
        if (this.sender.length || !endIsUnique)
            return -1;
        const stop = endIn(data, size, at + markSize, end) - at;
        if (stop < 0)
            return -1;
        if (!this.transparency)
            this.filled = this.place = stop;
        else {
            this.unstuff(data, at + stop - behindRegion, at, greatest);
            if (this.place !== stop - behindRegion)
                return -1;
            this.closeRegion();
            this.copy(data, size, at, this.filled + behindRegion);
        }
        this.payload = this.sender.payloadSize(this.filled);
        return this.payload < 0 ? -1 : this.behind(data, size, at);
    }
    /** The place behind the end, which has to stand here. */
    behind(data, size, at) {
        const { end } = this.frame;
        const place = at + this.place;
        const behind = place + end.length;
        for (let index = 0; index < end.length && place + index < size; index++) {
            if (data[place + index] !== end[index])
                return -1;
        }
        if (behind > size)
            return this.wait(data, size, at);
        return this.isClear(data, at, behind, behind) ? behind : -1;
    }
    wait(data, size, at) {
        const { transparency } = this;
        const { sevenBit } = this.frame;
        this.isWaiting = !(sevenBit && transparency) && this.isClear(data, at, size, -1);
        return -1;
    }
    /** True if nothing stands in the bytes up to a place that would end the frame. */
    isClear(data, at, to, behind) {
        const { marks } = this;
        // Of a strict stuffing nothing is left that would.
        if (this.transparency?.isStrict)
            return true;
        for (let place = at + this.clear; place < to; place++) {
            if (marks[data[place]] && this.isEnded(data, at, place, behind))
                return false;
        }
        this.clear = to - at;
        return true;
    }
    /** True if a frame that ends behind the place `behind` can't have this byte there. */
    isEnded(data, at, place, behind) {
        const { completesStart, startSize, frame } = this.sender;
        const { headSize, end } = frame;
        const byte = data[place];
        const index = place - at - headSize;
        const isPlain = !this.transparency && index >= 0 && index < this.payload;
        if (byte > 0x7f && frame.sevenBit && isPlain)
            return true;
        const first = place + 1 - startSize;
        if (frame.startIsUnique && completesStart[byte] && first > at) {
            if (frame.startWords.some((word) => standsAt(data, place + 1, first, word)))
                return true;
        }
        const stop = place + 1 - end.length;
        if (!frame.endIsUnique || place + 1 === behind || stop < at + frame.markSize)
            return false;
        return standsAt(data, place + 1, stop, end);
    }
    // --- content -------------------------------------------------------------------------------
    /** Take content until so much is there. False: more has to come. */
    fill(data, size, at, due) {
        const { transparency } = this;
        const { behindRegion } = this.frame;
        if (!transparency)
            this.filled = this.place = Math.min(due, size - at);
        else {
            this.unstuff(data, size, at, this.payload < 0 ? due : due - behindRegion);
            if (this.payload >= 0 && this.filled >= due - behindRegion) {
                this.closeRegion();
                this.copy(data, size, at, due);
            }
        }
        return this.filled >= due;
    }
    /** Take content up to the end of what is stuffed. */
    unstuff(data, size, at, due) {
        this.copy(data, size, at, Math.min(this.before, due));
        const { unstuffer } = this;
        if (this.filled < this.before || !unstuffer)
            return;
        unstuffer.filled = this.filled;
        this.place = unstuffer.fill(data, at + this.place, size, this.scratch, due) - at;
        this.filled = unstuffer.filled;
    }
    /** Take the end of what is stuffed, and what was held back. Throws a Fault. */
    closeRegion() {
        const rest = this.unstuffer?.finish() ?? NO_BYTES;
        this.unstuffer = null;
        for (let index = 0; index < rest.length; index++)
            this.scratch[this.filled++] = rest[index];
    }
    /** Take content that is not stuffed. */
    copy(data, size, at, due) {
        while (this.filled < due && at + this.place < size) {
            this.scratch[this.filled++] = data[at + this.place++];
        }
    }
    /** Read the parts in front of the payload that are there. False: one is not plainly right. */
    readHead(bytes, base) {
        const { head } = this;
        if (!this.passed)
            this.values = new Array(this.frame.slots);
        for (; this.passed < head.length; this.passed++) {
            const { offset, end, literal, number, slot, isByte } = head[this.passed];
            if (!number && !this.begins(bytes, base, offset, literal))
                return false;
            if (end > this.filled)
                return true;
            if (isByte)
                this.values[slot] = bytes[base + offset];
            else if (number) {
                const value = number.number.decode(bytes, base + offset);
                this.values[slot] = value;
                if (!isTaken(number, value))
                    return false;
                if (number === this.sender.length && this.measured(value) < 0)
                    return false;
            }
        }
        this.group = this.sender.group(this.values);
        return true;
    }
    /** True if what is there of a literal is right. */
    begins(bytes, base, offset, literal) {
        const size = Math.min(literal.length, this.filled - offset);
        for (let index = 0; index < size; index++) {
            if (bytes[base + offset + index] !== literal[index])
                return false;
        }
        return true;
    }
    /** The payload's size where the length has such a value; -1 where no frame has it. */
    measured(value) {
        const { base, optional } = this.sender.length;
        if (value === base)
            return 0;
        const size = value - base - optional;
        return size > 0 && size <= this.frame.greatestPayload ? size : -1;
    }
    /** The payload's size: by a length, or by the identity; -1 if neither tells it plainly. */
    payloadSize() {
        const { frame, length } = this.sender;
        const { group } = this;
        if (!length)
            return group?.fixed ?? -1;
        const size = this.measured(this.values[length.slot]);
        const isHeld = group && frame.rescans;
        return isHeld && !group.carried.some((sizes) => holds(sizes, size)) ? -1 : size;
    }
    // --- the complete frame --------------------------------------------------------------------
    /** The event of the frame; null where it is not right. Throws a Fault. */
    event(source, at, end) {
        const { data } = source;
        const offset = source.offset + at;
        const { group, values, sender, payload } = this;
        const { frame } = sender;
        const isPlain = !this.transparency;
        const bytes = isPlain ? data : this.scratch;
        const base = isPlain ? at : 0;
        const start = base + frame.headSize;
        const behind = start + payload;
        const size = end - at;
        for (let index = 0; index < frame.sums.length; index++) {
            if (!this.isRight(frame.sums[index], this.runs[index], bytes, base))
                return null;
        }
        if (!isPlain && frame.sevenBit && hasHighBit(bytes, start, behind))
            return null;
        const only = group && group.messages.length === 1 && !sender.isFitted ? group.messages[0] : null;
        if (!only || !holds(only.sizes, payload)) {
            return framed(source, offset, new Cut(size, values, bytes.slice(start, behind)));
        }
        const reader = this.reader.restart(bytes, start, behind, sender.held(only, values));
        const message = only.read(reader);
        reader.finish();
        return new Framed(offset, size, source, frame.partsOf(values), message);
    }
    isRight(sum, run, bytes, base) {
        const { payload } = this;
        const { headSize } = this.frame;
        const place = base + placeAt(sum.place, headSize, payload);
        if (run) {
            const from = base + placeAt(run.from, headSize, payload);
            const to = base + placeAt(run.to, headSize, payload);
            return sumIsRight(sum, sum.algorithm.compute(bytes, from, to), bytes, place);
        }
        const joined = concatenated(sum.covers.map((covered) => this.covered(covered, bytes, base)));
        return sumIsRight(sum, sum.algorithm.compute(joined, 0, joined.length), bytes, place);
    }
    covered(covered, bytes, base) {
        if ("bytes" in covered)
            return covered.bytes;
        if ("virtual" in covered)
            throw new Fault("checksum", "it covers what is not sent");
        const { headSize } = this.frame;
        const from = placeAt(covered.from, headSize, this.payload);
        return bytes.subarray(base + from, base + placeAt(covered.to, headSize, this.payload));
    }
}
/** True if the number can be any byte. */
function isAny(part) {
    return part?.number.isPlain === true && !(part.kind === "value" && part.isHeld);
}
/** True if a receiver takes a value of the number, whatever else is in the frame. */
function isTaken(part, value) {
    if (part.kind === "value")
        return !part.isHeld || mayBe(part, value);
    if (part.kind !== "length")
        return true;
    const length = value;
    return part.least <= length && length <= part.greatest;
}
/** The first place of an end; -1 where there is none. */
function endIn(data, size, from, end) {
    for (let place = data.indexOf(end[0], from); place >= 0 && place + end.length <= size;) {
        if (end.length === 1 || equal(data.subarray(place, place + end.length), end))
            return place;
        place = data.indexOf(end[0], place + 1);
    }
    return -1;
}
