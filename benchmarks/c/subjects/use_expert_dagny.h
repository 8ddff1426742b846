#include "expert_dagny.h"

static struct expert_dagny_decoder decoder;

/* What a command does is the application's: the value is the whole message. */
static inline void taken(uint8_t id) {
    if (id != 0) {
        *(uint8_t *)BENCH_MESSAGE = expert_dagny_value(&decoder);
        bench_seen(id == 'M' ? 0 : id == 'S' ? 1 : id == 'R' ? 2 : 3);
    }
}

#define EXPERT(rest) expert_dagny##rest
#define EXPERT_WHICH uint8_t
#include "use_expert_link.h"

static inline size_t subject_encode(uint8_t which, uint8_t *frame, size_t capacity) {
    const uint8_t id = which == 0 ? 'M' : which == 1 ? 'S' : which == 2 ? 'R' : 'P';
    return expert_dagny_frame(id, *(uint8_t *)BENCH_MESSAGE, frame, capacity);
}

#include "fill_dagny.h"
