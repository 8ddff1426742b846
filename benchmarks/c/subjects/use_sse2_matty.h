#define subject_feed bytewise_feed
#include "use_expert_matty.h"
#undef subject_feed
#include "sse2_matty.h"
#include "use_sse2.h"

static size_t whole(const uint8_t *data, size_t size) {
    size_t at = 0;
    bool complete;
    do {
        at += sse2_matty_next(&data[at], size - at, BENCH_MESSAGE, &complete);
        if (complete) {
            bench_seen(0);
        }
    } while (complete);
    return at;
}
