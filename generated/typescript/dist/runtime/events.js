/** Events of a decoder: each covers some bytes of the input, and all of them cover all of it. */
/** Base of events. The bytes are looked up where they came in, which nobody changes. */
class Span {
    constructor(offset, size, data, start) {
        this.offset = offset;
        this.size = size;
        this.data = data;
        this.start = start;
    }
    get raw() {
        return this.data.subarray(this.start, this.start + this.size);
    }
}
/** A valid frame. What is seldom asked for is made then. */
export class Framed extends Span {
    constructor(offset, size, data, start, 
    /** What knows the frame. */
    codec, parts, message, 
    /** The message's; null of an unknown one. */
    plan) {
        super(offset, size, data, start);
        this.codec = codec;
        this.parts = parts;
        this.message = message;
        this.plan = plan;
    }
    get kind() {
        return this.plan ? "message" : "unknown";
    }
    get sender() {
        return this.codec.frame.sender;
    }
    get form() {
        return this.codec.frame.form;
    }
}
/** A valid frame whose identity belongs to no message. */
export class UnknownFrame extends Framed {
    constructor(offset, size, data, start, codec, parts, payload) {
        super(offset, size, data, start, codec, parts, null, null);
        this.payload = payload;
    }
}
/** Bytes that are no frame. */
export class Invalid extends Span {
    constructor(offset, size, data, start, sender, reason, problem) {
        super(offset, size, data, start);
        this.sender = sender;
        this.reason = reason;
        this.problem = problem;
        this.kind = "invalid";
    }
}
/** The event of a complete frame, with the message of its payload. Throws a Fault. */
export function framed(codec, cut, offset, data, start, size) {
    const { values, payload } = cut;
    const parts = codec.frame.partsOf(values);
    const group = codec.group(values);
    if (!group)
        return new UnknownFrame(offset, size, data, start, codec, parts, payload);
    const [plan, message] = codec.read(group, payload, values);
    return new Framed(offset, size, data, start, codec, parts, message, plan);
}
