/*
 * One decoder of PREFIX, fed twice with the same input: byte by byte and in chunks.
 *
 * The first two bytes of what the fuzzer makes say how it is cut; the others are the input. Seen:
 * both ways find the same events; with all events, their sizes add up to the input, in order, and
 * none is empty; payloads are decoded from memory that holds just them. Beside this file stands what
 * says PREFIX, whether there are ALL_EVENTS, and whether the decoder POLLS: returns what it finds in
 * the place of calling a handler (see harness.py).
 */
struct JOIN(PREFIX, _seen) {
    uint32_t offset;   /* Where the next event has to start. */
    uint32_t digest;   /* Of all events. */
    uint32_t messages; /* How many frames had a message. */
};

static void JOIN(PREFIX, _mix)(struct JOIN(PREFIX, _seen) * seen, uint32_t value) {
    seen->digest = (seen->digest ^ value) * 16777619u;
}

static void JOIN(PREFIX, _take)(void *user, const struct JOIN(PREFIX, _event) * event) {
    struct JOIN(PREFIX, _seen) *const seen = user;
#if ALL_EVENTS
    REQUIRE(event->offset == seen->offset);
    REQUIRE(event->size != 0);
    seen->offset += event->size;
    JOIN(PREFIX, _mix)(seen, event->size);
    JOIN(PREFIX, _mix)(seen, (uint32_t)event->kind);
    JOIN(PREFIX, _mix)(seen, (uint32_t)event->reason);
#endif
    JOIN(PREFIX, _mix)(seen, (uint32_t)event->message);
    JOIN(PREFIX, _mix)(seen, (uint32_t)event->payload_size);
    if (event->payload != NULL) {
        struct JOIN(PREFIX, _event) copy = *event;
        uint8_t *const payload = malloc(event->payload_size);
        REQUIRE(payload != NULL || event->payload_size == 0);
        for (size_t i = 0; i < event->payload_size; i++) {
            payload[i] = event->payload[i];
            JOIN(PREFIX, _mix)(seen, payload[i]);
        }
        copy.payload = payload;
        JOIN(PREFIX, _dispatch)(seen, &copy);
        free(payload);
        seen->messages++;
    } else {
        REQUIRE(event->payload_size == 0);
    }
}

static void JOIN(PREFIX, _start)(struct JOIN(PREFIX, _decoder) * decoder, struct JOIN(PREFIX, _seen) * seen) {
#if POLLS
    (void)seen;
    JOIN(PREFIX, _decoder_init)(decoder);
#else
    JOIN(PREFIX, _decoder_init)(decoder, JOIN(PREFIX, _take), seen);
#endif
}

#if POLLS
static void JOIN(PREFIX, _drain)(struct JOIN(PREFIX, _decoder) * decoder, int message, struct JOIN(PREFIX, _seen) * seen) {
    for (; message != NO_MESSAGE; message = (int)JOIN(PREFIX, _decoder_next)(decoder)) {
        struct JOIN(PREFIX, _event) event;
        JOIN(PREFIX, _decoder_event)(decoder, message, &event);
        JOIN(PREFIX, _take)(seen, &event);
    }
}
#endif

static void JOIN(PREFIX, _push)(struct JOIN(PREFIX, _decoder) * decoder, uint8_t byte, struct JOIN(PREFIX, _seen) * seen) {
#if POLLS
    JOIN(PREFIX, _drain)(decoder, (int)JOIN(PREFIX, _decoder_push)(decoder, byte), seen);
#else
    (void)seen;
    JOIN(PREFIX, _decoder_push)(decoder, byte);
#endif
}

static void JOIN(PREFIX, _feed)(struct JOIN(PREFIX, _decoder) * decoder, const uint8_t *data, size_t size,
                                struct JOIN(PREFIX, _seen) * seen) {
#if POLLS
    struct JOIN(PREFIX, _event) event;
    do {
        const size_t taken = JOIN(PREFIX, _decoder_feed)(decoder, data, size, &event);
        REQUIRE(taken <= size);
        REQUIRE(taken == size || event.message != NO_MESSAGE);
        if (event.message != NO_MESSAGE) {
            JOIN(PREFIX, _take)(seen, &event);
        }
        data += taken;
        size -= taken;
    } while (event.message != NO_MESSAGE);
#else
    (void)seen;
    JOIN(PREFIX, _decoder_feed)(decoder, data, size);
#endif
}

static void JOIN(PREFIX, _flush)(struct JOIN(PREFIX, _decoder) * decoder, struct JOIN(PREFIX, _seen) * seen) {
#if POLLS
    JOIN(PREFIX, _drain)(decoder, (int)JOIN(PREFIX, _decoder_flush)(decoder), seen);
#else
    (void)seen;
    JOIN(PREFIX, _decoder_flush)(decoder);
#endif
}

static void JOIN(PREFIX, _run)(const uint8_t *data, size_t size, uint8_t cut, uint8_t end) {
    /* On the heap, so that a byte written behind a decoder is seen. */
    struct JOIN(PREFIX, _decoder) *const single = malloc(sizeof *single);
    struct JOIN(PREFIX, _decoder) *const chunked = malloc(sizeof *chunked);
    struct JOIN(PREFIX, _seen) by_byte = {0, 2166136261u, 0};
    struct JOIN(PREFIX, _seen) by_chunk = by_byte;
    const size_t silence = size * end / 256u; /* Where the line is silent in the middle. */
    uint32_t dice = cut;
    REQUIRE(single != NULL && chunked != NULL);
    memset(single, 0xA5, sizeof *single);
    memset(chunked, 0x5A, sizeof *chunked);
    JOIN(PREFIX, _start)(single, &by_byte);
    JOIN(PREFIX, _start)(chunked, &by_chunk);
    for (size_t i = 0; i < size; i++) {
        if (end != 0 && i == silence) {
            JOIN(PREFIX, _flush)(single, &by_byte);
        }
        JOIN(PREFIX, _push)(single, data[i], &by_byte);
    }
    JOIN(PREFIX, _flush)(single, &by_byte);
    for (size_t at = 0; at < size;) {
        const size_t stop = end != 0 && at < silence ? silence : size;
        size_t chunk;
        if (end != 0 && at == silence) {
            JOIN(PREFIX, _flush)(chunked, &by_chunk);
        }
        dice = dice * 1103515245u + 12345u;
        chunk = cut == 0 ? size : 1u + (dice >> 16) % cut;
        if (chunk > stop - at) {
            chunk = stop - at;
        }
        uint8_t *const bytes = malloc(chunk);
        REQUIRE(bytes != NULL);
        memcpy(bytes, data + at, chunk);
        JOIN(PREFIX, _feed)(chunked, bytes, chunk, &by_chunk);
        free(bytes);
        at += chunk;
    }
    JOIN(PREFIX, _flush)(chunked, &by_chunk);
#if ALL_EVENTS
    REQUIRE(by_byte.offset == size);
    REQUIRE(by_chunk.offset == size);
#endif
    REQUIRE(by_byte.messages == by_chunk.messages);
    REQUIRE(by_byte.digest == by_chunk.digest);
    free(single);
    free(chunked);
}
