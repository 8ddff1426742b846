#include "expert_tether.h"

static struct expert_tether_decoder decoder;

static inline void taken(uint8_t id) {
    if (id == EXPERT_TETHER_REPORT) {
        expert_tether_read_report(&decoder, BENCH_MESSAGE);
        bench_seen(0);
    } else if (id != 0) {
        expert_tether_read_alarm(&decoder, BENCH_MESSAGE);
        bench_seen(1);
    }
}

#define EXPERT(rest) expert_tether##rest
#define EXPERT_WHICH uint8_t
#include "use_expert_link.h"

static inline size_t subject_encode(uint8_t which, uint8_t *frame, size_t capacity) {
    return which == 0 ? expert_tether_frame_report(BENCH_MESSAGE, frame, capacity)
                      : expert_tether_frame_alarm(BENCH_MESSAGE, frame, capacity);
}

#define FILLED(message) expert_tether_##message
#include "fill_tether.h"
