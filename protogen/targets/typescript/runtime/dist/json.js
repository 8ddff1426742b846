/** Events as lines of JSON, equal to those of `protogen decode --format jsonl`. */
import { makerOf, unknownFrameOf } from "./assembly.js";
import { equal, toHex } from "./bytes.js";
import { EncodeError } from "./errors.js";
import { Framed, UnknownFrame } from "./events.js";
/** A value as JSON has it: bytes as hexadecimal digits, integers of any size as numbers. */
export function jsonValue(value) {
    if (value === null || value === undefined)
        return "null";
    if (typeof value === "bigint")
        return value.toString();
    if (typeof value === "number")
        return jsonNumber(value);
    if (value instanceof Uint8Array)
        return `"${toHex(value)}"`;
    if (Array.isArray(value))
        return `[${value.map(jsonValue).join(", ")}]`;
    if (typeof value === "object") {
        const entries = Object.entries(value).map(([key, item]) => member(key, jsonValue(item)));
        return `{${entries.join(", ")}}`;
    }
    return JSON.stringify(value);
}
/** A number; not-a-number and the infinities, which JSON does not have, are texts. */
function jsonNumber(value) {
    if (Number.isNaN(value))
        return '"nan"';
    if (!Number.isFinite(value))
        return value > 0 ? '"inf"' : '"-inf"';
    if (Object.is(value, -0))
        return "-0.0";
    // Only floats are so large: their last digits are not those of an integer.
    const isPlain = Number.isSafeInteger(value) || !Number.isInteger(value);
    return isPlain ? JSON.stringify(value) : value.toExponential();
}
/** A member of an object. Names in generated code that end with `_` are those of the schema. */
function member(key, value) {
    return `${JSON.stringify(key.replace(/_+$/, ""))}: ${value}`;
}
/** The line of an event. It has `raw` where encoding it would give other bytes. */
export function jsonLine(event) {
    const found = event;
    const members = [
        member("offset", String(found.offset)),
        member("size", String(found.size)),
        member("event", JSON.stringify(found.kind)),
    ];
    if (found instanceof Framed && found.message) {
        members.push(member("message", JSON.stringify(found.message.message)));
    }
    if (found.sender)
        members.push(member("sender", JSON.stringify(found.sender)));
    if (!(found instanceof Framed)) {
        members.push(member("reason", JSON.stringify(found.reason)));
        members.push(member("raw", jsonValue(found.raw)));
        return `{${members.join(", ")}}`;
    }
    if (found.form)
        members.push(member("form", JSON.stringify(found.form)));
    members.push(member("parts", jsonValue(found.parts)));
    if (found instanceof UnknownFrame)
        members.push(member("payload", jsonValue(found.payload)));
    else
        members.push(member("fields", jsonValue(fieldsOf(found.message))));
    if (!givesBack(found))
        members.push(member("raw", jsonValue(found.raw)));
    return `{${members.join(", ")}}`;
}
/** The fields of a message: all but its name. */
function fieldsOf(message) {
    const { message: _name, ...fields } = message;
    return fields;
}
function givesBack(event) {
    const { codec } = event.source;
    const parts = Object.fromEntries(codec.frame.shown.map((part) => [part.name, event.parts[part.key]]));
    try {
        const { message } = event;
        const wire = event instanceof UnknownFrame
            ? unknownFrameOf(codec, event.payload, parts)
            : makerOf(codec, codec.named(message.message)).make(message, parts, false);
        return equal(wire, event.raw);
    }
    catch (error) {
        if (error instanceof EncodeError)
            return false;
        throw error;
    }
}
