/** Decoders of streams. */
import type { Decoder } from "./decoder.js";
import type { Event } from "./events.js";
/** A stream of bytes into one of events, for `port.readable.pipeThrough(...)`. */
export declare function streamOf<Message, Parts>(decoder: Decoder<Message, Parts>): TransformStream<Uint8Array, Event<Message, Parts>>;
/** The events of chunks, as they come in. */
export declare function eventsOf<Message, Parts>(decoder: Decoder<Message, Parts>, chunks: AsyncIterable<Uint8Array> | Iterable<Uint8Array>): AsyncGenerator<Event<Message, Parts>, void, undefined>;
