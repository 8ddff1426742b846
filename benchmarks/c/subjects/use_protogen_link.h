/*
 * What subjects of generated decoders have in common, before which stand `decoder`, `take`, and
 *
 *   LINK(rest)    a name of the decoder with this rest
 *   NO_MESSAGE    what is returned where no message is complete
 *
 * BENCH_POLLS: the decoder says which message is complete; else it calls `take`.
 */
#if defined(BENCH_POLLS)
/* Memory of zeros is idle. */
static inline void subject_init(void) {}

static inline void subject_push(uint8_t byte) {
    __typeof__(LINK(_decoder_next)(&decoder)) message = LINK(_decoder_push)(&decoder, byte);
    for (; message != NO_MESSAGE; message = LINK(_decoder_next)(&decoder)) {
        struct LINK(_event) event;
        LINK(_decoder_event)(&decoder, message, &event);
        take(NULL, &event);
    }
}

static inline void subject_feed(const uint8_t *data, size_t size) {
    struct LINK(_event) event;
    do {
        const size_t used = LINK(_decoder_feed)(&decoder, data, size, &event);
        if (event.message != NO_MESSAGE) {
            take(NULL, &event);
        }
        data += used;
        size -= used;
    } while (event.message != NO_MESSAGE);
}
#else
static inline void subject_init(void) {
    LINK(_decoder_init)(&decoder, take, NULL);
}

static inline void subject_push(uint8_t byte) {
    LINK(_decoder_push)(&decoder, byte);
}

static inline void subject_feed(const uint8_t *data, size_t size) {
    LINK(_decoder_feed)(&decoder, data, size);
}
#endif
#undef LINK
#undef NO_MESSAGE
