/** Decoders of streams. */

import type { Decoder } from "./decoder.js";
import type { Event } from "./events.js";

/** A stream of bytes into one of events, for `port.readable.pipeThrough(...)`. */
export function streamOf<Message, Parts>(
  decoder: Decoder<Message, Parts>,
): TransformStream<Uint8Array, Event<Message, Parts>> {
  return new TransformStream<Uint8Array, Event<Message, Parts>>({
    transform(chunk, controller) {
      for (const event of decoder.feed(chunk)) controller.enqueue(event);
    },
    flush(controller) {
      for (const event of decoder.flush()) controller.enqueue(event);
    },
  });
}

/** The events of chunks, as they come in. */
export async function* eventsOf<Message, Parts>(
  decoder: Decoder<Message, Parts>,
  chunks: AsyncIterable<Uint8Array> | Iterable<Uint8Array>,
): AsyncGenerator<Event<Message, Parts>, void, undefined> {
  for await (const chunk of chunks) yield* decoder.feed(chunk);
  yield* decoder.flush();
}
