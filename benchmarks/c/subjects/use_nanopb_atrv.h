#include "use_nanopb.h"

static inline void subject_decode(uint8_t which, const uint8_t *payload, size_t size) {
    decoded(which, which == 0 ? read_motor_fields : sonar_data_fields, payload, size);
}

static inline size_t subject_encode(uint8_t which, uint8_t *payload, size_t capacity) {
    return encoded(which == 0 ? read_motor_fields : sonar_data_fields, payload, capacity);
}

#if defined(BENCH_FILL)
static void subject_fill(uint8_t which) {
    if (which == 0) {
        struct ReadMotor *const motor = BENCH_MESSAGE;
        motor->unknown = bench_random();
        motor->timestamp = bench_random();
        motor->axis = bench_random() & 1u;
        motor->position = (int32_t)bench_random();
        motor->velocity = (int32_t)bench_random();
        motor->acceleration = (int32_t)bench_random();
        motor->torque = (int32_t)bench_random();
    } else {
        struct SonarData *const sonar = BENCH_MESSAGE;
        size_t index;
        sonar->unknown = 2;
        sonar->timestamp = bench_random();
        sonar->readings_count = 17;
        for (index = 0; index < 17u; index++) {
            sonar->readings[index].cluster = (uint8_t)index;
            sonar->readings[index].distance = bench_random() & 0x7FFFu;
        }
    }
}
#endif
