/*
 * What subjects of the newer experts have in common, before which stand `decoder`, `taken`, and
 * EXPERT(rest), a name of the expert with this rest.
 */
static inline void subject_init(void) {}

static inline void subject_push(uint8_t byte) {
    taken(EXPERT(_push)(&decoder, byte));
}

static inline void subject_feed(const uint8_t *data, size_t size) {
    while (size != 0) {
        EXPERT_WHICH which;
        const size_t used = EXPERT(_feed)(&decoder, data, size, &which);
        taken(which);
        data += used;
        size -= used;
    }
}
#undef EXPERT
#undef EXPERT_WHICH
