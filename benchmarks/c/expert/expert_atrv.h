/* rFLEX's motor and sonar packets of an ATRV-Jr (17 sonars), by hand. */
#ifndef EXPERT_ATRV_H
#define EXPERT_ATRV_H

#include <stddef.h>
#include <stdint.h>

#include "expert_api.h"

#define EXPERT_ATRV_MOTOR 1u
#define EXPERT_ATRV_SONAR 2u
#define EXPERT_ATRV_READINGS 17u
#define EXPERT_ATRV_PAYLOAD 59u
/* The most that stuffing can make of a frame. */
#define EXPERT_ATRV_ROOM(payload) (4u + 3u * (5u + (payload)))

struct expert_atrv_motor {
    uint32_t unknown;
    uint32_t timestamp;
    uint8_t axis;
    int32_t position;
    int32_t velocity;
    int32_t acceleration;
    int32_t torque;
};

struct expert_atrv_reading {
    uint8_t cluster;
    uint16_t distance;
};

struct expert_atrv_sonar {
    uint32_t unknown;
    uint32_t timestamp;
    uint8_t count;
    struct expert_atrv_reading readings[EXPERT_ATRV_READINGS];
};

struct expert_atrv_decoder {
    uint8_t state;
    uint8_t size;
    uint8_t content[4u + EXPERT_ATRV_PAYLOAD + 1u]; /* class to checksum */
};

/* Takes a byte; returns which message it completes, or 0. */
EXPERT_API uint8_t expert_atrv_push(struct expert_atrv_decoder *decoder, uint8_t byte);
EXPERT_API size_t expert_atrv_feed(struct expert_atrv_decoder *decoder, const uint8_t *data, size_t size,
                        uint8_t *which);
static inline uint8_t expert_atrv_number(const struct expert_atrv_decoder *decoder) {
    return decoder->content[1];
}
EXPERT_API void expert_atrv_read_motor(const struct expert_atrv_decoder *decoder,
                            struct expert_atrv_motor *motor);
EXPERT_API void expert_atrv_read_sonar(const struct expert_atrv_decoder *decoder,
                            struct expert_atrv_sonar *sonar);

/* Return the size of the frame; 0 where a value is out of range or the buffer may be too short. */
EXPERT_API size_t expert_atrv_frame_motor(const struct expert_atrv_motor *motor, uint8_t number,
                               uint8_t *frame, size_t capacity);
EXPERT_API size_t expert_atrv_frame_sonar(const struct expert_atrv_sonar *sonar, uint8_t number,
                               uint8_t *frame, size_t capacity);

#endif
