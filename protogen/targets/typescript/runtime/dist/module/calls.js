/** What users call. Each generated module has all that is below the imports. */
import * as rt from "../index.js";
import { protocol } from "./shape.js";
/** Cuts what an endpoint sends into events. Without a name: what all of them send. */
export class Decoder extends rt.Decoder {
    constructor(sender) {
        super(protocol.senders(sender));
    }
}
/** Makes the frames of an endpoint, and advances their counters. */
export class Encoder extends rt.Encoder {
    constructor(sender) {
        super(protocol, sender);
    }
}
/** The message of exactly one frame. Throws a DecodeError. */
export function decode(frame, options = {}) {
    return protocol.decode(frame, options);
}
/** The frame of a message. Throws an EncodeError. */
export function encode(message, options = {}) {
    return protocol.encode(message, options);
}
/** A stream of bytes into one of events. */
export function decoderStream(sender) {
    return rt.streamOf(new Decoder(sender));
}
/** The events of chunks, as they come in. */
export function events(chunks, sender) {
    return rt.eventsOf(new Decoder(sender), chunks);
}
