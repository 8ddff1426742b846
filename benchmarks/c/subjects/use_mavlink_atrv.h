#define MAVLINK_MAX_PAYLOAD_LEN 60
#include "use_mavlink.h"
#include "atrv/mavlink.h"

static mavlink_message_t message;
static mavlink_status_t status;

static inline void subject_init(void) {}

static inline void subject_push(uint8_t byte) {
    if (mavlink_parse_char(MAVLINK_COMM_0, byte, &message, &status) != MAVLINK_FRAMING_OK) {
        return;
    }
    if (message.msgid == MAVLINK_MSG_ID_READ_MOTOR) {
        mavlink_msg_read_motor_decode(&message, BENCH_MESSAGE);
        bench_seen(0);
    } else if (message.msgid == MAVLINK_MSG_ID_SONAR_DATA) {
        mavlink_msg_sonar_data_decode(&message, BENCH_MESSAGE);
        bench_seen(1);
    }
}

static inline void subject_feed(const uint8_t *data, size_t size) {
    size_t index;
    for (index = 0; index < size; index++) {
        subject_push(data[index]);
    }
}

static inline size_t subject_encode(uint8_t which, uint8_t *frame, size_t capacity) {
    out = frame;
    out_end = frame + capacity;
    out_full = false;
    if (which == 0) {
        mavlink_msg_read_motor_send_struct(MAVLINK_COMM_0, BENCH_MESSAGE);
    } else {
        mavlink_msg_sonar_data_send_struct(MAVLINK_COMM_0, BENCH_MESSAGE);
    }
    return out_full ? 0 : (size_t)(out - frame);
}

#if defined(BENCH_FILL)
static void subject_fill(uint8_t which) {
    if (which == 0) {
        mavlink_read_motor_t *const motor = BENCH_MESSAGE;
        motor->unknown = bench_random();
        motor->timestamp = bench_random();
        motor->axis = bench_random() & 1u;
        motor->position = (int32_t)bench_random();
        motor->velocity = (int32_t)bench_random();
        motor->acceleration = (int32_t)bench_random();
        motor->torque = (int32_t)bench_random();
    } else {
        mavlink_sonar_data_t *const sonar = BENCH_MESSAGE;
        size_t index;
        sonar->unknown = 2;
        sonar->timestamp = bench_random();
        sonar->count = 17;
        for (index = 0; index < 17u; index++) {
            sonar->clusters[index] = (uint8_t)index;
            sonar->distances[index] = bench_random() & 0x7FFFu;
        }
    }
}
#endif
