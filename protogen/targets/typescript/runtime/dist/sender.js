/** A sender: its frame, with what is looked up of it. */
import { NO_BYTES } from "./bytes.js";
import { EncodeError, Fault } from "./errors.js";
import { areAmong, holds, NO_PARTS } from "./plan.js";
import { Reader } from "./reader.js";
import { Writer } from "./writer.js";
function only(runs) {
    const isOne = runs.every((each) => each.length === 1 && each[0][0] === each[0][1]);
    return isOne ? runs.map((each) => each[0][0]) : null;
}
function isFirstLength(part) {
    return part.kind === "length" && !part.isFurther;
}
/** The numbers of parts, those that are bits of others among them. */
export function numbersOf(parts) {
    return parts.flatMap((part) => {
        if (part.kind === "number")
            return [part.part];
        return part.kind === "bits" ? part.members : [];
    });
}
function offsetsOf(parts, isEmpty) {
    let offset = 0;
    const sizes = parts.map((part) => (isEmpty && part.isOptional ? 0 : part.size));
    return [0, ...sizes.map((size) => (offset += size))];
}
export class Sender {
    constructor(frame) {
        this.frame = frame;
        this.wide = [];
        this.messages = new Map();
        this.slots = new Map();
        /** Bytes that complete a start. None where the same literal ends frames. */
        this.completesStart = new Uint8Array(256);
        for (const group of frame.groups) {
            const values = only(group.identities);
            if (values)
                this.list(values, group);
            else
                this.wide.push(group);
        }
        const numbers = numbersOf(frame.parts);
        for (const part of [...frame.told, ...numbers])
            this.slots.set(part.name, part.slot);
        const sent = frame.groups.flatMap((group) => group.messages);
        for (const message of [...sent, ...frame.encodeOnly]) {
            if (!this.messages.has(message.name))
                this.messages.set(message.name, message);
        }
        const parts = [...frame.told.map((part) => ({ ...part, number: null })), ...numbers];
        this.identityParts = frame.identity.map((slot) => parts.find((part) => part.slot === slot));
        this.shownCounts = frame.shown.map(({ name }) => {
            const part = numbers.find((item) => item.name === name);
            return 256 ** (part?.number.size ?? 0);
        });
        this.offsets = offsetsOf(frame.parts, false);
        this.offsetsEmpty = offsetsOf(frame.parts, true);
        this.valueParts = numbers.filter((part) => part.kind === "value");
        this.startSize = frame.startWords[0]?.length ?? 0;
        const own = frame.sharesDelimiter ? [] : frame.startWords;
        for (const word of own)
            this.completesStart[word[word.length - 1]] = 1;
        this.toldLength = frame.told.find((part) => part.length)?.length ?? null;
        this.length = this.toldLength ?? numbersOf(frame.parts).find(isFirstLength) ?? null;
        this.isFitted = frame.kept !== null || frame.isCut;
        this.hasWireSum = frame.sums.some((sum) => sum.overWire);
        this.emptyFrame = NO_BYTES;
        if (frame.start === "after_end")
            this.emptyFrame = frame.end;
        else if (frame.sharesDelimiter) {
            this.emptyFrame = Uint8Array.of(...frame.startBytes, ...frame.end);
        }
    }
    list(values, group) {
        const last = values.length - 1;
        if (last < 0)
            this.listed = group;
        let listed = (this.listed ?? (this.listed = new Map()));
        values.forEach((value, index) => {
            if (index === last)
                listed.set(value, group);
            else {
                if (!listed.has(value))
                    listed.set(value, new Map());
                listed = listed.get(value);
            }
        });
    }
    get key() {
        const { sender, form } = this.frame;
        return form ? `${sender}_${form}` : sender;
    }
    /** The identity among the values of a frame. */
    identity(values) {
        return this.frame.identity.map((slot) => values[slot]);
    }
    /** The messages of an identity; undefined where it is unknown. */
    group(values) {
        const { identity: slots } = this.frame;
        let found = this.listed;
        for (let index = 0; found && index < slots.length; index++) {
            found = found.get(values[slots[index]]);
        }
        if (found || !this.wide.length)
            return found;
        const identity = this.identity(values);
        return this.wide.find((group) => areAmong(group.identities, identity));
    }
    /** The value of a part that is not sent; null where the identity gives it none. */
    virtual(index, values) {
        const part = this.frame.virtual[index];
        const identity = this.identity(values);
        const found = part.values.find((item) => areAmong(item.identities, identity));
        const value = found ? found.value : part.default;
        if (value === null)
            return null;
        const bytes = new Uint8Array(part.number.size);
        part.number.encode(value, bytes, 0);
        return bytes;
    }
    tailSize(payload) {
        return payload ? this.frame.tailSize : this.frame.tailSizeEmpty;
    }
    /** The payload's size where the content has that size; -1 if there is none. */
    payloadSize(content) {
        const extra = content - this.frame.headSize;
        if (extra === this.frame.tailSizeEmpty)
            return 0;
        const size = extra - this.frame.tailSize;
        return size > 0 ? size : -1;
    }
    /** What a receiver has to be told of the size of a frame, by its slot. */
    tellSize(values, payload) {
        const { toldLength } = this;
        if (!toldLength || payload < 0)
            return;
        const { base, optional, slot } = toldLength;
        values[slot] = base + (payload ? payload + optional : 0);
    }
    /** The parts of a frame that are fields of the message, among the values of the frame. */
    held(message, values) {
        if (!message.held.length)
            return NO_PARTS;
        return Object.fromEntries(message.held.map((name) => [name, values[this.slots.get(name)]]));
    }
    /** Bytes that are known of a payload; null where its fields take all of it. */
    knownOf(message, payload, held) {
        return message.tellsItsEnd ? prefixSize(message, payload, held) : message.known;
    }
    /** What a frame has of a payload, cut or filled up to its size; null: that varies. */
    fitted(payload, size) {
        if (size === null)
            return payload;
        const cut = this.frame.isCut ? payload.subarray(0, size) : payload;
        if (this.frame.kept === null || cut.length >= size)
            return cut;
        const filled = new Uint8Array(size);
        filled.set(cut);
        return filled;
    }
    leaves(message, size) {
        return this.frame.isCut && message.tellsItsEnd && size > message.sizes.least;
    }
    /** The message of a frame's payload and values. Throws a Fault. */
    read(group, payload, values) {
        const [first] = group.messages;
        let known = payload;
        if (this.leaves(first, payload.length)) {
            known = this.fitted(payload, this.knownOf(first, payload, this.held(first, values)));
        }
        else if (this.isFitted) {
            const sizes = new Set(group.messages.map((message) => message.known));
            known = this.fitted(payload, sizes.size === 1 ? first.known : null);
        }
        const fitting = group.messages.find((message) => holds(message.sizes, known.length)) ?? first;
        return readPayload(fitting, known, this.held(fitting, values));
    }
    /** The parts that events show, out of one number. */
    separated(joined) {
        const { shownCounts } = this;
        const values = shownCounts.map(() => 0);
        let rest = joined;
        for (let index = shownCounts.length - 1; index >= 0; index--) {
            const count = shownCounts[index];
            values[index] = rest % count;
            rest = Math.floor(rest / count);
        }
        return this.frame.partsOf(values);
    }
    /** The message called `name`, if the endpoint sends one. */
    named(name) {
        return this.messages.get(name);
    }
}
/** The message of a payload's bytes; `held` has the parts that are fields. Throws a Fault. */
export function readPayload(message, payload, held = NO_PARTS) {
    const size = payload.length;
    if (!holds(message.sizes, size)) {
        const problem = `${message.name} does not have ${size} bytes of payload`;
        throw new Fault("size", problem, "", Math.min(size, message.sizes.greatest));
    }
    const reader = new Reader(payload, held);
    const found = message.read(reader);
    reader.finish();
    return found;
}
/** The payload of a message. Throws an EncodeError. */
export function writePayload(message, value, strict) {
    const writer = writerOf(strict, 0);
    message.write(writer, value);
    checkSize(message, writer.size);
    return writer.taken();
}
const WRITER = /* @__PURE__ */ new Writer();
/**
 * What writes a payload behind so many bytes. It is that of all frames, one after another.
 *
 * With a size, it writes into an array of so many bytes, which are all that it has to write.
 */
export function writerOf(strict, from, size = 0) {
    return WRITER.restart(strict, from, size);
}
/** Throw an EncodeError unless a message can have a payload of so many bytes. */
export function checkSize(message, size) {
    if (!holds(message.sizes, size)) {
        const problem = `makes ${size} bytes of payload, which ${message.name} can't have`;
        throw new EncodeError("", problem);
    }
}
/** Bytes at the start of `data` that the message takes. Throws a Fault. */
export function prefixSize(message, data, held) {
    const reader = new Reader(data, held);
    message.read(reader);
    return reader.at;
}
