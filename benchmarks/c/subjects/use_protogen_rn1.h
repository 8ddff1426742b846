#include "rn1.h"

static struct rn1_brain_decoder decoder;

static void take(void *user, const struct rn1_brain_event *event) {
    (void)user;
    if (event->message == RN1_MESSAGE_GYRO) {
        rn1_gyro_load(BENCH_MESSAGE, event->payload);
        bench_seen(0);
    } else if (event->message == RN1_MESSAGE_LIDAR) {
        rn1_lidar_load(BENCH_MESSAGE, event->payload);
        bench_seen(1);
    }
}

#define LINK(rest) rn1_brain##rest
#define NO_MESSAGE RN1_NO_MESSAGE
#include "use_protogen_link.h"

static inline size_t subject_encode(uint8_t which, uint8_t *frame, size_t capacity) {
    if (which == 0) {
        return rn1_gyro_frame(BENCH_MESSAGE, frame, capacity);
    }
#if defined(BENCH_SINK)
    return rn1_lidar_send(BENCH_MESSAGE, bench_put, NULL) == RN1_OK ? RN1_LIDAR_FRAME_MAX : 0;
#else
    return rn1_lidar_frame(BENCH_MESSAGE, frame, capacity);
#endif
}

#if defined(BENCH_FILL)
static void subject_fill(uint8_t which) {
    if (which == 0) {
        struct rn1_gyro *const gyro = BENCH_MESSAGE;
        gyro->status = bench_random() & 1u;
        gyro->int_x = (int16_t)((int)(bench_random() & 0x3FFFu) - 0x2000);
        gyro->int_y = (int16_t)((int)(bench_random() & 0x3FFFu) - 0x2000);
        gyro->int_z = (int16_t)((int)(bench_random() & 0x3FFFu) - 0x2000);
    } else {
        struct rn1_lidar *const lidar = BENCH_MESSAGE;
        size_t index;
        lidar->status = bench_random() & 3u;
        for (index = 0; index < 360u; index++) {
            lidar->distances[index] = bench_random() & 0x3FFFu;
        }
    }
}
#endif
