/* RN#1's gyro and lidar, by hand. Specialised: these two messages, nothing else. */
#ifndef EXPERT_RN1_H
#define EXPERT_RN1_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "expert_api.h"

#define EXPERT_RN1_GYRO 0x80u
#define EXPERT_RN1_LIDAR 0x84u
#define EXPERT_RN1_GYRO_FRAME 8u
#define EXPERT_RN1_POINTS 360u
#define EXPERT_RN1_LIDAR_FRAME 722u

struct expert_rn1_gyro {
    uint8_t status;
    int16_t integral[3]; /* x, y, z */
};

struct expert_rn1_lidar {
    uint8_t status;
    uint16_t distances[EXPERT_RN1_POINTS];
};

struct expert_rn1_decoder {
    uint16_t left;
    uint16_t at;
    uint8_t id;
    uint8_t payload[EXPERT_RN1_LIDAR_FRAME - 1u];
};

/* Takes a byte; returns the identity of the message that it completes, or 0. */
EXPERT_API uint8_t expert_rn1_push(struct expert_rn1_decoder *decoder, uint8_t byte);
/* Takes bytes up to the end of a message; returns how many, and its identity or 0. */
EXPERT_API size_t expert_rn1_feed(struct expert_rn1_decoder *decoder, const uint8_t *data, size_t size,
                       uint8_t *id);
EXPERT_API void expert_rn1_read_gyro(const struct expert_rn1_decoder *decoder, struct expert_rn1_gyro *gyro);
EXPERT_API void expert_rn1_read_lidar(const struct expert_rn1_decoder *decoder,
                           struct expert_rn1_lidar *lidar);

/* Return the size of the frame; 0 where a value is out of range or the buffer too short. */
EXPERT_API size_t expert_rn1_frame_gyro(const struct expert_rn1_gyro *gyro, uint8_t *frame, size_t capacity);
EXPERT_API size_t expert_rn1_frame_lidar(const struct expert_rn1_lidar *lidar, uint8_t *frame,
                              size_t capacity);
/* Hands the frame to a function; sends nothing where a value is out of range. */
EXPERT_API bool expert_rn1_send_lidar(const struct expert_rn1_lidar *lidar,
                           void (*put)(void *user, uint8_t byte), void *user);

#endif
