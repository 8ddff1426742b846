#include "matty.h"

static struct matty_esp_decoder decoder;

static void take(void *user, const struct matty_esp_event *event) {
    (void)user;
    if (event->message == MATTY_MESSAGE_STATUS) {
        matty_status_load(BENCH_MESSAGE, event->payload);
        bench_seen(0);
    }
}

#define LINK(rest) matty_esp##rest
#define NO_MESSAGE MATTY_NO_MESSAGE
#include "use_protogen_link.h"

static inline size_t subject_encode(uint8_t which, uint8_t *frame, size_t capacity) {
    (void)which;
    return matty_status_frame(BENCH_MESSAGE, 7, frame, capacity);
}

#if defined(BENCH_FILL)
static void subject_fill(uint8_t which) {
    struct matty_status *const status = BENCH_MESSAGE;
    (void)which;
    status->status = (uint8_t)bench_random();
    status->mode = bench_random() & 3u;
    status->voltage = (uint16_t)bench_random();
    status->current = (uint16_t)bench_random();
    status->speed = (int16_t)bench_random();
    status->angle = (int16_t)bench_random();
    status->encoder0 = (uint16_t)bench_random();
    status->encoder1 = (uint16_t)bench_random();
    status->encoder2 = (uint16_t)bench_random();
    status->encoder3 = (uint16_t)bench_random();
}
#endif
