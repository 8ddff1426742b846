#include "expert_uherobot.h"

static struct expert_uherobot_decoder decoder;

static inline void taken(bool complete) {
    if (complete) {
        expert_uherobot_read(&decoder, BENCH_MESSAGE);
        bench_seen(0);
    }
}

#define EXPERT(rest) expert_uherobot##rest
#define EXPERT_WHICH bool
#include "use_expert_link.h"

static inline size_t subject_encode(uint8_t which, uint8_t *frame, size_t capacity) {
    (void)which;
    return expert_uherobot_frame(BENCH_MESSAGE, frame, capacity);
}

#define FILLED(message) expert_uherobot_##message
#include "fill_uherobot.h"
