#define subject_feed bytewise_feed
#include "use_expert_atrv.h"
#undef subject_feed
#include "sse2_atrv.h"
#include "use_sse2.h"

static size_t whole(const uint8_t *data, size_t size) {
    size_t at = 0;
    uint8_t which;
    do {
        at += sse2_atrv_next(&data[at], size - at, BENCH_MESSAGE, BENCH_MESSAGE, &which);
        if (which != 0) {
            bench_seen(which == EXPERT_ATRV_MOTOR ? 0 : 1);
        }
    } while (which != 0);
    return at;
}
