/** A frame's content, read as the frame's parts while it comes in. */
import { equal, NO_BYTES } from "./bytes.js";
import { Fault, spelled } from "./errors.js";
import { holds } from "./plan.js";
import { prefixSize } from "./sender.js";
/** Takes content byte by byte and says what is known of the frame. */
export class Content {
    constructor(sender, told) {
        this.sender = sender;
        this.bytes = new Uint8Array(32);
        this.size = 0;
        /** The part that is due. */
        this.index = 0;
        /** The payload's size; -1 while it is not known. */
        this.payloadSize = -1;
        /** True if the payload has begun, and only what follows will tell its size. */
        this.isOpen = false;
        /** True if all parts are there. */
        this.isFull = false;
        /** Bytes that the content has at most, as soon as that is known; else -1. */
        this.limit = -1;
        /** Wire bytes up to the end of what is stuffed, where the length says that; else -1. */
        this.regionEnd = -1;
        this.isMeasuring = false;
        this.next = -1;
        this.literal = NO_BYTES;
        this.clearBits = false;
        const { frame } = sender;
        this.values = new Array(frame.slots).fill(undefined);
        for (const part of frame.told)
            this.values[part.slot] = told[part.slot] ?? part.default;
    }
    /** Take what was told, before the first byte. Throws a Fault where no frame has it. */
    begin() {
        const { toldLength, frame } = this.sender;
        if (toldLength)
            this.readLength(toldLength);
        if (frame.lastIdentity < 0)
            this.identify();
        this.enter();
    }
    /** Take the next byte. True: a part was completed, and more may be known. */
    accept(byte) {
        const index = this.size;
        if (this.limit >= 0 && index >= this.limit)
            throw this.surplus();
        if (index === this.bytes.length) {
            const larger = new Uint8Array(2 * index);
            larger.set(this.bytes);
            this.bytes = larger;
        }
        this.bytes[index] = byte;
        this.size = index + 1;
        const { literal } = this;
        if (literal.length && byte !== literal[literal.length + index - this.next]) {
            throw new Fault("value", `${spelled([byte])} is not ${this.part.name}`);
        }
        if (byte > 0x7f && this.clearBits) {
            throw new Fault("encoding", `${spelled([byte])} has its most significant bit set`);
        }
        if (index + 1 !== this.next)
            return false;
        this.leave();
        return true;
    }
    /** The verdict on a byte behind the content's last one. */
    surplus() {
        if (this.payloadSize < 0) {
            return new Fault("size", "no message of this identity has so many bytes");
        }
        return new Fault(this.announced, `there are more than ${this.limit} bytes, or no end`);
    }
    /** Take the end of the content. Throws a Fault where the frame can't end here. */
    close() {
        if (this.payloadSize < 0 && this.sender.length?.overWire) {
            throw new Fault("length", "the frame ends before its length says");
        }
        if (this.payloadSize < 0) {
            this.closeOpen("truncated", "the frame ends before all of its parts are there");
        }
        else if (!this.isFull) {
            const problem = `the frame ends behind ${this.size} of ${this.limit} bytes`;
            throw new Fault(this.announced, problem);
        }
    }
    /** Take the end of all content, where the length says that it is. */
    closeCounted() {
        this.closeOpen("length", "the length leaves no room for all parts");
        this.limit = this.size;
        this.isFull = true;
    }
    // --- part by part --------------------------------------------------------------------------
    get part() {
        return this.sender.frame.parts[this.index];
    }
    /** The reason where there are more or fewer bytes than announced. */
    get announced() {
        return this.sender.length ? "length" : "size";
    }
    /** Begin the next part that has bytes. */
    enter() {
        const { parts } = this.sender.frame;
        while (this.index < parts.length && this.isAbsent(parts[this.index]))
            this.index++;
        this.literal = NO_BYTES;
        this.clearBits = false;
        this.next = -1;
        if (this.index === parts.length) {
            this.isFull = true;
            return;
        }
        const { part } = this;
        if (part.kind === "payload") {
            this.enterPayload();
            return;
        }
        this.next = this.size + part.size;
        if (part.kind === "literal")
            this.literal = part.bytes;
    }
    isAbsent(part) {
        return this.payloadSize === 0 && (part.kind === "payload" || part.isOptional === true);
    }
    /** End the part that is due. */
    leave() {
        if (this.isMeasuring) {
            this.measure();
            return;
        }
        const { part } = this;
        this.readPart(part, this.size - part.size);
        this.index++;
        this.enter();
    }
    /** Take the numbers of a part, and then what they tell. */
    readPart(part, at) {
        if (part.kind === "number") {
            this.read(part.part, at);
            this.learn([part.part]);
        }
        else if (part.kind === "bits") {
            const whole = BigInt(part.number.decode(this.bytes, at));
            if ((whole & part.mask) !== part.fixed) {
                throw new Fault("value", `bits of ${part.name} that are always the same are others`);
            }
            for (const member of part.members)
                this.read(member, at);
            for (const mirror of part.mirrors) {
                const due = BigInt(this.values[mirror.of]) ^ mirror.flips;
                if (BigInt(mirror.number.decode(this.bytes, at)) !== due) {
                    throw new Fault("value", `${mirror.name} has to be ${due}`);
                }
            }
            this.learn(part.members);
        }
    }
    learn(numbers) {
        const { frame } = this.sender;
        for (const item of numbers) {
            if (item.kind === "length" && !item.isFurther)
                this.readLength(item);
        }
        if (frame.identityIsEarly && numbers.some((item) => item.slot === frame.lastIdentity)) {
            this.identify();
        }
        for (const item of numbers)
            if (item.kind === "length" && item.isFurther)
                this.agree(item);
    }
    read(part, at) {
        const value = part.number.decode(this.bytes, at);
        this.values[part.slot] = value;
        if (part.kind === "value" && part.isHeld && !mayBe(part, value)) {
            throw new Fault("value", `${part.name} can't be ${value}`);
        }
    }
    // --- how large the payload is --------------------------------------------------------------
    readLength(part) {
        const value = this.values[part.slot];
        const wrong = new Fault("length", `${part.name} is ${value}`);
        if (part.overWire) {
            if (value < part.base || value > part.greatest)
                throw wrong;
            this.regionEnd = value - part.base + (part.regionEnd ?? 0);
            return;
        }
        const isEmpty = value === part.base;
        const size = isEmpty ? 0 : value - part.base - part.optional;
        const isTaken = part.least <= value && value <= part.greatest;
        if (!isTaken || size > this.sender.frame.greatestPayload || !(isEmpty || size > 0))
            throw wrong;
        this.setPayload(size);
        this.compare();
    }
    /** Hold another length against the size that the first one told. */
    agree(part) {
        const size = this.payloadSize;
        const due = part.base + (size ? size + part.optional : 0);
        const value = this.values[part.slot];
        if (value !== due) {
            throw new Fault("length", `${part.name} is ${value}, and has to be ${due}`);
        }
    }
    /** Find the messages of the identity, and what they say about the size. */
    identify() {
        this.group = this.sender.group(this.values);
        const fixed = this.group?.fixed ?? null;
        if (fixed !== null && !this.sender.length)
            this.setPayload(fixed);
        this.compare();
    }
    /** Hold the size that the length tells against those of the identity's messages. */
    compare() {
        const { group, payloadSize: size } = this;
        const { frame } = this.sender;
        if (!group || size < 0 || !frame.rescans || !this.sender.length)
            return;
        if (!group.carried.some((sizes) => holds(sizes, size))) {
            throw new Fault("size", `no message of this identity has ${size} bytes of payload`);
        }
    }
    setPayload(size) {
        this.payloadSize = size;
        this.limit = this.sender.frame.headSize + size + this.sender.tailSize(size);
    }
    enterPayload() {
        const { frame } = this.sender;
        if (this.payloadSize >= 0) {
            this.next = this.size + this.payloadSize;
            this.clearBits = frame.sevenBit;
        }
        else if (frame.end.length || frame.endsIdle || this.sender.length?.overWire || !this.group) {
            this.openPayload();
        }
        else {
            this.isMeasuring = true;
            this.clearBits = frame.sevenBit;
            this.measure();
        }
    }
    openPayload() {
        const { frame } = this.sender;
        this.isOpen = true;
        // With parts behind the payload, its last bytes can't be told from theirs yet.
        this.clearBits = frame.sevenBit && this.index === frame.parts.length - 1;
        if (this.group && !this.sender.length?.overWire) {
            const { greatest } = this.group;
            this.limit = frame.headSize + greatest + this.sender.tailSize(greatest);
        }
    }
    /** Try to read a message that nothing delimits but itself. */
    measure() {
        const { frame } = this.sender;
        const start = this.bytes.subarray(frame.headSize, this.size);
        try {
            const [message] = this.group.messages;
            const held = this.sender.held(message, this.values);
            this.setPayload(prefixSize(message, start, held));
        }
        catch (error) {
            if (!(error instanceof Fault))
                throw error;
            // How far ahead a reader looks is its own matter; that the room is full is not.
            const left = frame.greatest - frame.headSize - frame.tailSize - start.length;
            if (!error.missing || left <= 0)
                throw error;
            this.next = this.size + Math.min(error.missing, left);
            return;
        }
        this.isMeasuring = false;
        this.index++;
        this.enter();
    }
    // --- the end of an open payload ------------------------------------------------------------
    closeOpen(reason, problem) {
        const { frame } = this.sender;
        const size = this.isOpen ? this.sender.payloadSize(this.size) : -1;
        if (size < 0)
            throw new Fault(reason, problem);
        this.payloadSize = size;
        let at = frame.headSize;
        if (frame.sevenBit && this.bytes.subarray(at, at + size).some((byte) => byte > 0x7f)) {
            throw new Fault("encoding", "a byte of the payload has its most significant bit set");
        }
        at += size;
        for (const part of frame.parts.slice(frame.payloadIndex + 1)) {
            if (part.isOptional && !size)
                continue;
            const data = this.bytes.subarray(at, at + part.size);
            if (part.kind === "literal" && !equal(data, part.bytes)) {
                throw new Fault("value", `${spelled(data)} is not ${part.name}`);
            }
            this.readPart(part, at);
            at += part.size;
        }
    }
}
/** True if a value is one that the part can have. */
export function mayBe(part, value) {
    if (part.values)
        return part.values.includes(value);
    if (part.between !== undefined) {
        const [first, last] = [part.between[0], part.between[1]];
        const text = String(value).padEnd(part.number.size, "\0");
        return [...text].every((character) => first <= character && character <= last);
    }
    const { least, greatest } = part;
    if (typeof value === "string" || typeof least === "string" || typeof greatest === "string") {
        return true;
    }
    return least <= value && value <= greatest;
}
