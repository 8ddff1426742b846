#include "framed.h"

static struct framed_board_decoder decoder;

static void take(void *user, const struct framed_board_event *event) {
    (void)user;
    framed_sample_load(BENCH_MESSAGE, event->payload);
    bench_seen(0);
}

#define LINK(rest) framed_board##rest
#define NO_MESSAGE FRAMED_NO_MESSAGE
#include "use_protogen_link.h"

static inline size_t subject_encode(uint8_t which, uint8_t *frame, size_t capacity) {
    (void)which;
    return framed_sample_frame(BENCH_MESSAGE, frame, capacity);
}

#if defined(BENCH_FILL)
static void subject_fill(uint8_t which) {
    struct framed_sample *const sample = BENCH_MESSAGE;
    (void)which;
    sample->time = bench_random();
    sample->speed = (int16_t)bench_random();
    sample->force = (uint16_t)bench_random();
}
#endif
