/** Events of a decoder: each covers some bytes of the input, and all of them cover all of it. */
import {} from "./candidate.js";
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
    constructor(kind, offset, size, data, start, 
    /** What knows the frame. */
    codec, 
    /** Values of its parts, by their slots. */
    values, payload, message, plan) {
        super(offset, size, data, start);
        this.kind = kind;
        this.codec = codec;
        this.values = values;
        this.payload = payload;
        this.message = message;
        this.plan = plan;
    }
    get sender() {
        return this.codec.frame.sender;
    }
    get form() {
        return this.codec.frame.form;
    }
    get parts() {
        const found = {};
        for (const part of this.codec.frame.shown)
            found[part.key] = this.values[part.slot];
        return found;
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
    const group = codec.group(values);
    const [plan, message] = group ? codec.read(group, payload, values) : [null, null];
    const kind = plan ? "message" : "unknown";
    return new Framed(kind, offset, size, data, start, codec, values, payload, message, plan);
}
