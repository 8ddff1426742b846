#define subject_feed bytewise_feed
#include "use_expert_rn1.h"
#undef subject_feed
#include "sse2_rn1.h"
#include "use_sse2.h"

static size_t whole(const uint8_t *data, size_t size) {
    size_t at = 0;
    uint8_t id;
    do {
        at += sse2_rn1_next(&data[at], size - at, BENCH_MESSAGE, BENCH_MESSAGE, &id);
        if (id != 0) {
            bench_seen(id == EXPERT_RN1_GYRO ? 0 : 1);
        }
    } while (id != 0);
    return at;
}
