/** Events of a decoder: each covers some bytes of the input, and all of them cover all of it. */
/** Bytes that came in, which nobody changes, and what reads them. Many events have the same. */
export class Source {
    constructor(
    /** What knows the frames. */
    codec, data, 
    /** Of the first of these bytes, counted from the start of the input. */
    offset) {
        this.codec = codec;
        this.data = data;
        this.offset = offset;
    }
    /** The bytes that an event covers. */
    raw({ offset, size }) {
        const start = offset - this.offset;
        return this.data.subarray(start, start + size);
    }
}
/** A valid frame. What is seldom asked for is looked up then, so that there is less of each. */
export class Framed {
    constructor(offset, size, source, shown, message) {
        this.offset = offset;
        this.size = size;
        this.source = source;
        this.shown = shown;
        this.message = message;
    }
    get parts() {
        const { shown } = this;
        return typeof shown === "number" ? this.source.codec.separated(shown) : shown;
    }
    get kind() {
        return this.message ? "message" : "unknown";
    }
    get raw() {
        return this.source.raw(this);
    }
    get sender() {
        return this.source.codec.frame.sender;
    }
    get form() {
        return this.source.codec.frame.form;
    }
}
/** A valid frame whose identity belongs to no message. */
export class UnknownFrame extends Framed {
    constructor(offset, size, source, parts, payload) {
        super(offset, size, source, parts, null);
        this.payload = payload;
    }
}
/** Bytes that are no frame. */
export class Invalid {
    constructor(offset, size, source, sender, reason, problem) {
        this.offset = offset;
        this.size = size;
        this.source = source;
        this.sender = sender;
        this.reason = reason;
        this.problem = problem;
        this.kind = "invalid";
    }
    get raw() {
        return this.source.raw(this);
    }
}
/** The event of a complete frame, with the message of its payload. Throws a Fault. */
export function framed(source, offset, { size, values, payload }) {
    const { codec } = source;
    const parts = codec.frame.partsOf(values);
    const group = codec.group(values);
    if (!group)
        return new UnknownFrame(offset, size, source, parts, payload);
    return new Framed(offset, size, source, parts, codec.read(group, payload, values));
}
