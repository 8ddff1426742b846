#define MAVLINK_MAX_PAYLOAD_LEN 18
#include "use_mavlink.h"
#include "matty/mavlink.h"

static mavlink_message_t message;
static mavlink_status_t status;

static inline void subject_init(void) {}

static inline void subject_push(uint8_t byte) {
    if (mavlink_parse_char(MAVLINK_COMM_0, byte, &message, &status) == MAVLINK_FRAMING_OK &&
        message.msgid == MAVLINK_MSG_ID_ROBOT_STATUS) {
        mavlink_msg_robot_status_decode(&message, BENCH_MESSAGE);
        bench_seen(0);
    }
}

static inline void subject_feed(const uint8_t *data, size_t size) {
    size_t index;
    for (index = 0; index < size; index++) {
        subject_push(data[index]);
    }
}

static inline size_t subject_encode(uint8_t which, uint8_t *frame, size_t capacity) {
    (void)which;
    out = frame;
    out_end = frame + capacity;
    out_full = false;
    mavlink_msg_robot_status_send_struct(MAVLINK_COMM_0, BENCH_MESSAGE);
    return out_full ? 0 : (size_t)(out - frame);
}

#if defined(BENCH_FILL)
static void subject_fill(uint8_t which) {
    mavlink_robot_status_t *const robot = BENCH_MESSAGE;
    (void)which;
    robot->status = (uint8_t)bench_random();
    robot->mode = bench_random() & 3u;
    robot->voltage = (uint16_t)bench_random();
    robot->current = (uint16_t)bench_random();
    robot->speed = (int16_t)bench_random();
    robot->angle = (int16_t)bench_random();
    robot->encoder0 = (uint16_t)bench_random();
    robot->encoder1 = (uint16_t)bench_random();
    robot->encoder2 = (uint16_t)bench_random();
    robot->encoder3 = (uint16_t)bench_random();
}
#endif
