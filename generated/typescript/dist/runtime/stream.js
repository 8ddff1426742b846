/** Decoders of streams. */
/** A stream of bytes into one of events, for `port.readable.pipeThrough(...)`. */
export function streamOf(decoder) {
    return new TransformStream({
        transform(chunk, controller) {
            for (const event of decoder.feed(chunk))
                controller.enqueue(event);
        },
        flush(controller) {
            for (const event of decoder.flush())
                controller.enqueue(event);
        },
    });
}
/** The events of chunks, as they come in. */
export async function* eventsOf(decoder, chunks) {
    for await (const chunk of chunks)
        yield* decoder.feed(chunk);
    yield* decoder.flush();
}
