/**
 * Frames that stand in the input as a whole and are plainly in order, taken without a candidate.
 *
 * Whatever is not plain is left to a candidate, which looks at it byte by byte and knows the reason.
 */
import { concatenated, equal, NO_BYTES, standsAt } from "./bytes.js";
import { Cut, sumIsRight } from "./candidate.js";
import { mayBe } from "./content.js";
import { Fault } from "./errors.js";
import { framed, Framed } from "./events.js";
import { at as placeAt, holds } from "./plan.js";
import { Reader } from "./reader.js";
/** Takes whole frames of one sender. */
export class WholeFrames {
    constructor(sender) {
        this.sender = sender;
        this.literals = [];
        this.numbers = [];
        this.reader = new Reader(NO_BYTES);
        this.values = [];
        const { frame } = sender;
        let offset = 0;
        frame.parts.slice(0, frame.payloadIndex).forEach((part) => {
            if (part.kind === "literal")
                this.literals.push({ item: part, offset });
            if (part.kind === "number")
                this.numbers.push({ item: part.part, offset });
            offset += part.size;
        });
        const inFront = frame.parts.slice(0, Math.max(0, frame.firstStuffed));
        this.before = inFront.reduce((size, part) => size + part.size, 0);
        this.scratch = new Uint8Array(frame.greatest + 1);
    }
    /** What takes the frames of a sender; null where the frame does not allow that. */
    static of(sender) {
        const { frame } = sender;
        const isPlain = frame.parts.every((part, index) => part.kind !== "bits" && (index < frame.payloadIndex || !part.isOptional));
        const isTold = frame.told.length > 0 || frame.virtual.length > 0;
        const allows = frame.takesWhole && isPlain && !isTold && !frame.sharesDelimiter;
        return allows && !sender.hasWireSum ? new WholeFrames(sender) : null;
    }
    /** The event of the frame there; null: a candidate has to look. */
    take(data, size, at, offset) {
        const { frame } = this.sender;
        try {
            const found = this.find(data, size, at);
            if (!found || found.end - at > frame.givenUpAt || this.startsInside(data, at, found.end)) {
                return null;
            }
            const start = found.base + frame.headSize;
            const behind = start + found.payload;
            for (const sum of frame.sums)
                if (!this.isRight(sum, found))
                    return null;
            if (frame.sevenBit && hasHighBit(found.bytes, start, behind))
                return null;
            return this.event(found, data, at, offset + at);
        }
        catch (error) {
            if (error instanceof Fault)
                return null;
            throw error;
        }
    }
    /** The event of a frame that is right. Throws a Fault where its payload is no message's. */
    event(found, data, at, offset) {
        const { group, values, sender } = this;
        const size = found.end - at;
        const start = found.base + sender.frame.headSize;
        const only = group?.messages.length === 1 && !sender.isFitted ? group.messages[0] : null;
        if (!only || !holds(only.sizes, found.payload)) {
            const payload = found.bytes.slice(start, start + found.payload);
            return framed(sender, new Cut(size, values, payload), offset, data, at, size);
        }
        const reader = this.reader.restart(found.bytes, start, start + found.payload, sender.held(only, values));
        const message = only.read(reader);
        reader.finish();
        return new Framed("message", offset, size, data, at, sender, values, NO_BYTES, message, only);
    }
    find(data, size, at) {
        const { frame } = this.sender;
        if (size - at < frame.least)
            return null;
        if (frame.start === "after_end" && standsAt(data, size, at, frame.end))
            return null;
        const stop = frame.endIsUnique ? endIn(data, size, at + frame.markSize, frame.end) : -1;
        if (frame.endIsUnique && stop < 0)
            return null;
        return frame.transparency ? this.stuffed(data, size, at, stop) : this.plain(data, size, at, stop);
    }
    plain(data, size, at, stop) {
        const { headSize, end } = this.sender.frame;
        if (at + headSize > size || !this.readHead(data, at))
            return null;
        const payload = this.payloadSize(stop - at);
        if (payload < 0)
            return null;
        const behind = at + headSize + payload + this.sender.tailSize(payload);
        if (stop < 0 ? !standsAt(data, size, behind, end) : behind !== stop)
            return null;
        return behind > size ? null : { bytes: data, base: at, payload, end: behind + end.length };
    }
    /** The same where some of it is stuffed. */
    stuffed(data, size, at, stop) {
        const { headSize, transparency, behindRegion, end } = this.sender.frame;
        const { before, scratch } = this;
        const last = stop < 0 ? size : stop - behindRegion;
        const unstuffer = transparency.decoder();
        for (let index = 0; index < before; index++)
            scratch[index] = data[at + index];
        let filled = before;
        let place = at + before;
        let payload = -1;
        let due = stop < 0 ? headSize : scratch.length;
        while (place < last && filled < due) {
            const released = unstuffer.push(data[place++]);
            for (let index = 0; index < released.length; index++)
                scratch[filled++] = released[index];
            if (stop < 0 && payload < 0 && filled >= headSize) {
                if (!this.readHead(scratch, 0))
                    return null;
                payload = this.payloadSize(-1);
                if (payload < 0)
                    return null;
                due = headSize + payload + this.sender.tailSize(payload) - behindRegion;
            }
        }
        const rest = unstuffer.finish();
        if (stop < 0 ? rest.length || filled !== due || payload < 0 : place !== last)
            return null;
        for (let index = 0; index < rest.length; index++)
            scratch[filled++] = rest[index];
        if (place + behindRegion + end.length > size)
            return null;
        for (let index = 0; index < behindRegion; index++)
            scratch[filled++] = data[place++];
        if (!standsAt(data, size, place, end))
            return null;
        if (stop >= 0) {
            if (filled < headSize || !this.readHead(scratch, 0))
                return null;
            payload = this.payloadSize(filled);
            const whole = headSize + payload + this.sender.tailSize(payload);
            if (payload < 0 || whole !== filled)
                return null;
        }
        return { bytes: scratch, base: 0, payload, end: place + end.length };
    }
    /** Read the parts in front of the payload. False: they are not plainly those of a frame. */
    readHead(bytes, base) {
        for (const { item, offset } of this.literals) {
            if (!standsAt(bytes, bytes.length, base + offset, item.bytes))
                return false;
        }
        const values = new Array(this.sender.frame.slots);
        for (const { item, offset } of this.numbers) {
            const value = item.number.decode(bytes, base + offset);
            values[item.slot] = value;
            if (item.kind === "value" && item.isHeld && !mayBe(item, value))
                return false;
        }
        this.values = values;
        this.group = this.sender.group(values);
        return true;
    }
    /** The payload's size: by a length, or by the identity, or by all content; -1 if none is plain. */
    payloadSize(content) {
        const { frame, length } = this.sender;
        const { group } = this;
        if (!length) {
            return group && group.fixed !== null
                ? group.fixed
                : content < 0
                    ? -1
                    : this.sender.payloadSize(content);
        }
        const value = this.values[length.slot];
        const size = value === length.base ? 0 : value - length.base - length.optional;
        if (value < length.least || value > length.greatest)
            return -1;
        if (size > frame.greatestPayload || (size <= 0 && value !== length.base))
            return -1;
        const isHeld = group && frame.rescans;
        return isHeld && !group.carried.some((sizes) => holds(sizes, size)) ? -1 : size;
    }
    /** True if a start stands inside that would end the frame. */
    startsInside(data, at, end) {
        const { completesStart, startSize, frame } = this.sender;
        if (!frame.startIsUnique)
            return false;
        for (let place = at + startSize; place < end; place++) {
            if (!completesStart[data[place]])
                continue;
            const first = place + 1 - startSize;
            if (first > at && frame.startWords.some((word) => standsAt(data, end, first, word))) {
                return true;
            }
        }
        return false;
    }
    isRight(sum, found) {
        const { headSize } = this.sender.frame;
        const { base, bytes, payload } = found;
        const place = base + placeAt(sum.place, headSize, payload);
        const [first] = sum.covers;
        if (sum.covers.length === 1 && first && "from" in first) {
            const from = base + placeAt(first.from, headSize, payload);
            const to = base + placeAt(first.to, headSize, payload);
            return sumIsRight(sum, sum.algorithm.compute(bytes, from, to), bytes, place);
        }
        const joined = concatenated(sum.covers.map((covered) => this.covered(covered, found)));
        return sumIsRight(sum, sum.algorithm.compute(joined, 0, joined.length), bytes, place);
    }
    covered(covered, { bytes, base, payload }) {
        if ("bytes" in covered)
            return covered.bytes;
        if ("virtual" in covered)
            throw new Fault("checksum", "it covers what is not sent");
        const { headSize } = this.sender.frame;
        const from = placeAt(covered.from, headSize, payload);
        return bytes.subarray(base + from, base + placeAt(covered.to, headSize, payload));
    }
}
function hasHighBit(bytes, from, to) {
    for (let place = from; place < to; place++)
        if (bytes[place] > 0x7f)
            return true;
    return false;
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
