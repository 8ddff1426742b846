#include "atrv.h"

static struct atrv_flex_decoder decoder;

static void take(void *user, const struct atrv_flex_event *event) {
    (void)user;
    if (event->message == ATRV_MESSAGE_READ_MOTOR) {
        atrv_read_motor_load(BENCH_MESSAGE, event->payload);
        bench_seen(0);
    } else if (event->message == ATRV_MESSAGE_SONAR_DATA) {
        atrv_sonar_data_load(BENCH_MESSAGE, event->payload, event->payload_size);
        bench_seen(1);
    }
}

#define LINK(rest) atrv_flex##rest
#define NO_MESSAGE ATRV_NO_MESSAGE
#include "use_protogen_link.h"

static inline size_t subject_encode(uint8_t which, uint8_t *frame, size_t capacity) {
    if (which == 0) {
        return atrv_read_motor_frame(BENCH_MESSAGE, 0xFF, frame, capacity);
    } else {
        return atrv_sonar_data_frame(BENCH_MESSAGE, 0xFF, frame, capacity);
    }
}

#if defined(BENCH_FILL)
static void subject_fill(uint8_t which) {
    if (which == 0) {
        struct atrv_read_motor *const motor = BENCH_MESSAGE;
        motor->unknown = bench_random();
        motor->timestamp = bench_random();
        motor->axis = bench_random() & 1u;
        motor->position = (int32_t)bench_random();
        motor->velocity = (int32_t)bench_random();
        motor->acceleration = (int32_t)bench_random();
        motor->torque = (int32_t)bench_random();
    } else {
        struct atrv_sonar_data *const sonar = BENCH_MESSAGE;
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
