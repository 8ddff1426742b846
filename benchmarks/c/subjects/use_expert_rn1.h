#include "expert_rn1.h"

static struct expert_rn1_decoder decoder;

static inline void taken(uint8_t id) {
    if (id == EXPERT_RN1_GYRO) {
        expert_rn1_read_gyro(&decoder, BENCH_MESSAGE);
        bench_seen(0);
    } else if (id != 0) {
        expert_rn1_read_lidar(&decoder, BENCH_MESSAGE);
        bench_seen(1);
    }
}

#define EXPERT(rest) expert_rn1##rest
#define EXPERT_WHICH uint8_t
#include "use_expert_link.h"

static inline size_t subject_encode(uint8_t which, uint8_t *frame, size_t capacity) {
    if (which == 0) {
        return expert_rn1_frame_gyro(BENCH_MESSAGE, frame, capacity);
    }
#if defined(BENCH_SINK)
    return expert_rn1_send_lidar(BENCH_MESSAGE, bench_put, NULL) ? EXPERT_RN1_LIDAR_FRAME : 0;
#else
    return expert_rn1_frame_lidar(BENCH_MESSAGE, frame, capacity);
#endif
}

#if defined(BENCH_FILL)
static void subject_fill(uint8_t which) {
    if (which == 0) {
        struct expert_rn1_gyro *const gyro = BENCH_MESSAGE;
        gyro->status = bench_random() & 1u;
        gyro->integral[0] = (int16_t)((int)(bench_random() & 0x3FFFu) - 0x2000);
        gyro->integral[1] = (int16_t)((int)(bench_random() & 0x3FFFu) - 0x2000);
        gyro->integral[2] = (int16_t)((int)(bench_random() & 0x3FFFu) - 0x2000);
    } else {
        struct expert_rn1_lidar *const lidar = BENCH_MESSAGE;
        size_t index;
        lidar->status = bench_random() & 3u;
        for (index = 0; index < 360u; index++) {
            lidar->distances[index] = bench_random() & 0x3FFFu;
        }
    }
}
#endif
