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

#if defined(BENCH_POLLS)
/* Memory of zeros is idle. */
static inline void subject_init(void) {}

static inline void subject_push(uint8_t byte) {
    struct atrv_flex_event event;
    atrv_flex_decoder_event(&decoder, atrv_flex_decoder_push(&decoder, byte), &event);
    take(NULL, &event);
}

static inline void subject_feed(const uint8_t *data, size_t size) {
    while (size != 0) {
        struct atrv_flex_event event;
        const size_t used = atrv_flex_decoder_feed(&decoder, data, size, &event);
        if (event.message != ATRV_NO_MESSAGE) {
            take(NULL, &event);
        }
        data += used;
        size -= used;
    }
}
#else
static inline void subject_init(void) {
    atrv_flex_decoder_init(&decoder, take, NULL);
}

static inline void subject_push(uint8_t byte) {
    atrv_flex_decoder_push(&decoder, byte);
}

static inline void subject_feed(const uint8_t *data, size_t size) {
    atrv_flex_decoder_feed(&decoder, data, size);
}
#endif

static inline size_t subject_encode(uint8_t which, uint8_t *frame, size_t capacity) {
    size_t size = 0;
    enum atrv_result result;
    if (which == 0) {
        result = atrv_read_motor_frame(BENCH_MESSAGE, 0xFF, frame, capacity, &size);
    } else {
        result = atrv_sonar_data_frame(BENCH_MESSAGE, 0xFF, frame, capacity, &size);
    }
    return result == ATRV_OK ? size : 0;
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
