/* All five messages are one dialect here, on three links. */
#define MAVLINK_MAX_PAYLOAD_LEN 182
#define LINKS 3
#include "use_mavlink.h"
#include "all/mavlink.h"

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

static void take(void) {
    switch (message.msgid) {
    case MAVLINK_MSG_ID_GYRO:
        mavlink_msg_gyro_decode(&message, BENCH_MESSAGE);
        bench_seen(0);
        break;
    case MAVLINK_MSG_ID_LIDAR_QUARTER:
        take_quarter();
        break;
    case MAVLINK_MSG_ID_READ_MOTOR:
        mavlink_msg_read_motor_decode(&message, BENCH_MESSAGE);
        bench_seen(2);
        break;
    case MAVLINK_MSG_ID_SONAR_DATA:
        mavlink_msg_sonar_data_decode(&message, BENCH_MESSAGE);
        bench_seen(3);
        break;
    case MAVLINK_MSG_ID_ROBOT_STATUS:
        mavlink_msg_robot_status_decode(&message, BENCH_MESSAGE);
        bench_seen(4);
        break;
    default:
        break;
    }
}

static inline void subject_push(uint8_t byte) {
    uint8_t link;
    for (link = 0; link < LINKS; link++) {
        if (mavlink_parse_char(link, byte, &message, &status) == MAVLINK_FRAMING_OK) {
            take();
        }
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
    switch (which) {
    case 0:
        mavlink_msg_gyro_send_struct(MAVLINK_COMM_0, BENCH_MESSAGE);
        break;
    case 1:
        out_end = NULL;
        return send_lidar();
    case 2:
        mavlink_msg_read_motor_send_struct(MAVLINK_COMM_1, BENCH_MESSAGE);
        break;
    case 3:
        mavlink_msg_sonar_data_send_struct(MAVLINK_COMM_1, BENCH_MESSAGE);
        break;
    default:
        mavlink_msg_robot_status_send_struct(MAVLINK_COMM_2, BENCH_MESSAGE);
        break;
    }
    return out_full ? 0 : (size_t)(out - frame);
}
