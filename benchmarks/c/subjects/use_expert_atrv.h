#include "expert_atrv.h"

static struct expert_atrv_decoder decoder;

static inline void taken(uint8_t which) {
    if (which == EXPERT_ATRV_MOTOR) {
        expert_atrv_read_motor(&decoder, BENCH_MESSAGE);
        bench_seen(0);
    } else if (which != 0) {
        expert_atrv_read_sonar(&decoder, BENCH_MESSAGE);
        bench_seen(1);
    }
}

#define EXPERT(rest) expert_atrv##rest
#define EXPERT_WHICH uint8_t
#include "use_expert_link.h"

static inline size_t subject_encode(uint8_t which, uint8_t *frame, size_t capacity) {
    return which == 0 ? expert_atrv_frame_motor(BENCH_MESSAGE, 0xFF, frame, capacity)
                      : expert_atrv_frame_sonar(BENCH_MESSAGE, 0xFF, frame, capacity);
}

#if defined(BENCH_FILL)
static void subject_fill(uint8_t which) {
    if (which == 0) {
        struct expert_atrv_motor *const motor = BENCH_MESSAGE;
        motor->unknown = bench_random();
        motor->timestamp = bench_random();
        motor->axis = bench_random() & 1u;
        motor->position = (int32_t)bench_random();
        motor->velocity = (int32_t)bench_random();
        motor->acceleration = (int32_t)bench_random();
        motor->torque = (int32_t)bench_random();
    } else {
        struct expert_atrv_sonar *const sonar = BENCH_MESSAGE;
        size_t index;
        sonar->unknown = 2;
        sonar->timestamp = bench_random();
        sonar->count = 17;
        for (index = 0; index < 17u; index++) {
            sonar->readings[index].cluster = (uint8_t)index;
            sonar->readings[index].distance = bench_random() & 0x7FFFu;
        }
    }
}
#endif
