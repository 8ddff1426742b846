#include "use_nanopb.h"

static inline const pb_field_t *fields_of(uint8_t which) {
    switch (which) {
    case 0:
        return gyro_fields;
    case 1:
        return lidar_fields;
    case 2:
        return read_motor_fields;
    case 3:
        return sonar_data_fields;
    default:
        return status_fields;
    }
}

static inline void subject_decode(uint8_t which, const uint8_t *payload, size_t size) {
    decoded(which, fields_of(which), payload, size);
}

static inline size_t subject_encode(uint8_t which, uint8_t *payload, size_t capacity) {
    return which == 1 ? sent(lidar_fields) : encoded(fields_of(which), payload, capacity);
}
