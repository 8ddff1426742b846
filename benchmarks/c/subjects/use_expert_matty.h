#include "expert_matty.h"

static struct expert_matty_decoder decoder;

static inline void taken(bool complete) {
    if (complete) {
        expert_matty_read(&decoder, BENCH_MESSAGE);
        bench_seen(0);
    }
}

#define EXPERT(rest) expert_matty##rest
#define EXPERT_WHICH bool
#include "use_expert_link.h"

static inline size_t subject_encode(uint8_t which, uint8_t *frame, size_t capacity) {
    (void)which;
    return expert_matty_frame(BENCH_MESSAGE, 7, frame, capacity);
}

#if defined(BENCH_FILL)
static void subject_fill(uint8_t which) {
    struct expert_matty_status *const status = BENCH_MESSAGE;
    size_t index;
    (void)which;
    status->status = (uint8_t)bench_random();
    status->mode = bench_random() & 3u;
    status->voltage = (uint16_t)bench_random();
    status->current = (uint16_t)bench_random();
    status->speed = (int16_t)bench_random();
    status->angle = (int16_t)bench_random();
    for (index = 0; index < 4u; index++) {
        status->encoders[index] = (uint16_t)bench_random();
    }
}
#endif
