#include "use_nanopb.h"

static inline void subject_decode(uint8_t which, const uint8_t *payload, size_t size) {
    decoded(which, which == 0 ? gyro_fields : lidar_fields, payload, size);
}

static inline size_t subject_encode(uint8_t which, uint8_t *payload, size_t capacity) {
    if (which == 0) {
        return encoded(gyro_fields, payload, capacity);
    }
#if defined(BENCH_SINK)
    return sent(lidar_fields);
#else
    return encoded(lidar_fields, payload, capacity);
#endif
}

#if defined(BENCH_FILL)
static void subject_fill(uint8_t which) {
    if (which == 0) {
        struct Gyro *const gyro = BENCH_MESSAGE;
        gyro->status = bench_random() & 1u;
        gyro->x = (int16_t)((int)(bench_random() & 0x3FFFu) - 0x2000);
        gyro->y = (int16_t)((int)(bench_random() & 0x3FFFu) - 0x2000);
        gyro->z = (int16_t)((int)(bench_random() & 0x3FFFu) - 0x2000);
    } else {
        struct Lidar *const lidar = BENCH_MESSAGE;
        size_t index;
        lidar->status = bench_random() & 3u;
        lidar->distances_count = 360;
        for (index = 0; index < 360u; index++) {
            lidar->distances[index] = bench_random() & 0x3FFFu;
        }
    }
}
#endif
