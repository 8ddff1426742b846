#include "use_nanopb.h"

static inline void subject_decode(uint8_t which, const uint8_t *payload, size_t size) {
    decoded(which, status_fields, payload, size);
}

static inline size_t subject_encode(uint8_t which, uint8_t *payload, size_t capacity) {
    (void)which;
    return encoded(status_fields, payload, capacity);
}

#if defined(BENCH_FILL)
static void subject_fill(uint8_t which) {
    struct Status *const status = BENCH_MESSAGE;
    size_t index;
    (void)which;
    status->status = (uint8_t)bench_random();
    status->mode = bench_random() & 3u;
    status->voltage = (uint16_t)bench_random();
    status->current = (uint16_t)bench_random();
    status->speed = (int16_t)bench_random();
    status->angle = (int16_t)bench_random();
    status->encoders_count = 4;
    for (index = 0; index < 4u; index++) {
        status->encoders[index] = (uint16_t)bench_random();
    }
}
#endif
