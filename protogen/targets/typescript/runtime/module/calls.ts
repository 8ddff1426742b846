/** What users call. Each generated module has all that is below the imports. */

import * as rt from "../index.js";
import { protocol, type GivenParts, type MessageInput, type Senders } from "./shape.js";

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
export class Decoder<S extends SenderName = SenderName> extends rt.Decoder<Senders[S]["message"], Senders[S]["parts"]> {
  constructor(sender?: S) {
    super(protocol.senders(sender));
  }
}

/** Makes the frames of an endpoint, and advances their counters. */
export class Encoder extends rt.Encoder<MessageInput, GivenParts> {
  constructor(sender: SenderName) {
    super(protocol, sender);
  }
}

/** The message of exactly one frame. Throws a DecodeError. */
export function decode<S extends SenderName = SenderName>(frame: Uint8Array, options: DecodeOptions<S> = {}): Senders[S]["message"] {
  return protocol.decode(frame, options);
}

/** The frame of a message. Throws an EncodeError. */
export function encode(message: MessageInput, options: EncodeOptions = {}): Uint8Array {
  return protocol.encode(message, options);
}

/** A stream of bytes into one of events. */
export function decoderStream<S extends SenderName = SenderName>(sender?: S): TransformStream<Uint8Array, Event<S>> {
  return rt.streamOf(new Decoder(sender));
}

/** The events of chunks, as they come in. */
export function events<S extends SenderName = SenderName>(chunks: AsyncIterable<Uint8Array> | Iterable<Uint8Array>, sender?: S): AsyncGenerator<Event<S>, void, undefined> {
  return rt.eventsOf(new Decoder(sender), chunks);
}
