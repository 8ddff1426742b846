/** What users call. Each generated module has all that is below the imports. */
import * as rt from "../index.js";
import { type GivenParts, type MessageInput, type Senders } from "./shape.js";
/** Name of an endpoint that sends. */
export type SenderName = keyof Senders;
/** Any message. */
export type Message = Senders[SenderName]["message"];
/** What a decoder yields. */
export type Event<S extends SenderName = SenderName> = rt.Event<Senders[S]["message"], Senders[S]["parts"]>;
/** Choices of an encoder. */
export type EncodeOptions = rt.EncodeOptions<GivenParts, SenderName>;
/** Choices of `decode`. */
export type DecodeOptions<S extends SenderName = SenderName> = rt.DecodeOptions<S>;
/** Cuts what an endpoint sends into events. Without a name: what all of them send. */
export declare class Decoder<S extends SenderName = SenderName> extends rt.Decoder<Senders[S]["message"], Senders[S]["parts"]> {
    constructor(sender?: S);
}
/** Makes the frames of an endpoint, and advances their counters. */
export declare class Encoder extends rt.Encoder<MessageInput, GivenParts> {
    constructor(sender: SenderName);
}
/** The message of exactly one frame. Throws a DecodeError. */
export declare function decode<S extends SenderName = SenderName>(frame: Uint8Array, options?: DecodeOptions<S>): Senders[S]["message"];
/** The frame of a message. Throws an EncodeError. */
export declare function encode(message: MessageInput, options?: EncodeOptions): Uint8Array;
/** A stream of bytes into one of events. */
export declare function decoderStream<S extends SenderName = SenderName>(sender?: S): TransformStream<Uint8Array, Event<S>>;
/** The events of chunks, as they come in. */
export declare function events<S extends SenderName = SenderName>(chunks: AsyncIterable<Uint8Array> | Iterable<Uint8Array>, sender?: S): AsyncGenerator<Event<S>, void, undefined>;
