#define MAVLINK_MAX_PAYLOAD_LEN 182
#include "use_mavlink.h"
#include "rn1/mavlink.h"

struct lidar {
    uint8_t status;
    uint16_t distances[360];
};

static mavlink_message_t message;
static mavlink_status_t status;
static uint8_t quarters;

static inline void subject_init(void) {}

static void take_quarter(void) {
    struct lidar *const lidar = BENCH_MESSAGE;
    const uint8_t quarter = mavlink_msg_lidar_quarter_get_quarter(&message);
    if (quarter > 3u) {
        return;
    }
    lidar->status = mavlink_msg_lidar_quarter_get_status(&message);
    mavlink_msg_lidar_quarter_get_distances(&message, &lidar->distances[quarter * 90u]);
    quarters = quarter == quarters ? (uint8_t)(quarters + 1u) : 0u;
    if (quarters == 4u) {
        quarters = 0;
        bench_seen(1);
    }
}

static inline void subject_push(uint8_t byte) {
    if (mavlink_parse_char(MAVLINK_COMM_0, byte, &message, &status) != MAVLINK_FRAMING_OK) {
        return;
    }
    if (message.msgid == MAVLINK_MSG_ID_GYRO) {
        mavlink_msg_gyro_decode(&message, BENCH_MESSAGE);
        bench_seen(0);
    } else if (message.msgid == MAVLINK_MSG_ID_LIDAR_QUARTER) {
        take_quarter();
    }
}

static inline void subject_feed(const uint8_t *data, size_t size) {
    size_t index;
    for (index = 0; index < size; index++) {
        subject_push(data[index]);
    }
}

static size_t send_lidar(void) {
    const struct lidar *const lidar = BENCH_MESSAGE;
    uint8_t quarter;
    for (quarter = 0; quarter < 4u; quarter++) {
        mavlink_msg_lidar_quarter_send(MAVLINK_COMM_0, quarter, lidar->status,
                                       &lidar->distances[quarter * 90u]);
    }
    return 4u * 194u;
}

static inline size_t subject_encode(uint8_t which, uint8_t *frame, size_t capacity) {
    out = frame;
    out_end = frame + capacity;
    out_full = false;
    if (which == 0) {
        mavlink_msg_gyro_send_struct(MAVLINK_COMM_0, BENCH_MESSAGE);
    } else {
#if defined(BENCH_SINK)
        out_end = NULL;
        return send_lidar();
#else
        send_lidar();
#endif
    }
    return out_full ? 0 : (size_t)(out - frame);
}

#if defined(BENCH_FILL)
static void subject_fill(uint8_t which) {
    if (which == 0) {
        mavlink_gyro_t *const gyro = BENCH_MESSAGE;
        gyro->status = bench_random() & 1u;
        gyro->int_x = (int16_t)((int)(bench_random() & 0x3FFFu) - 0x2000);
        gyro->int_y = (int16_t)((int)(bench_random() & 0x3FFFu) - 0x2000);
        gyro->int_z = (int16_t)((int)(bench_random() & 0x3FFFu) - 0x2000);
    } else {
        struct lidar *const lidar = BENCH_MESSAGE;
        size_t index;
        lidar->status = bench_random() & 3u;
        for (index = 0; index < 360u; index++) {
            lidar->distances[index] = bench_random() & 0x3FFFu;
        }
    }
}
#endif
