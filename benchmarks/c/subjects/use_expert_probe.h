#include "expert_probe.h"

static struct expert_probe_decoder decoder;

static inline void taken(uint8_t id) {
    if (id == EXPERT_PROBE_ATTITUDE) {
        expert_probe_read_attitude(&decoder, BENCH_MESSAGE);
        bench_seen(0);
    } else if (id != 0) {
        expert_probe_read_power(&decoder, BENCH_MESSAGE);
        bench_seen(1);
    }
}

#define EXPERT(rest) expert_probe##rest
#define EXPERT_WHICH uint8_t
#include "use_expert_link.h"

static inline size_t subject_encode(uint8_t which, uint8_t *frame, size_t capacity) {
    return which == 0 ? expert_probe_frame_attitude(BENCH_MESSAGE, frame, capacity)
                      : expert_probe_frame_power(BENCH_MESSAGE, frame, capacity);
}

#define FILLED(message) expert_probe_##message
#include "fill_probe.h"
