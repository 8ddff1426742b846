/* The rover's state of README.md, by hand: COBS and CRC-16/KERMIT. */
#ifndef EXPERT_ROVER_H
#define EXPERT_ROVER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "expert_api.h"

#define EXPERT_ROVER_CONTENT 8u /* identity, five bytes, checksum */
#define EXPERT_ROVER_FRAME 10u

struct expert_rover_state {
    uint8_t mode;
    uint16_t battery;
    int16_t heading;
};

struct expert_rover_decoder {
    uint8_t left; /* Bytes up to the next code of COBS. */
    uint8_t size;
    uint8_t content[1u + EXPERT_ROVER_CONTENT]; /* Each group's zero in front of it. */
};

/* Takes a byte; returns whether it completes a state. */
EXPERT_API bool expert_rover_push(struct expert_rover_decoder *decoder, uint8_t byte);
EXPERT_API size_t expert_rover_feed(struct expert_rover_decoder *decoder, const uint8_t *data,
                                    size_t size, bool *complete);
EXPERT_API void expert_rover_read(const struct expert_rover_decoder *decoder,
                                  struct expert_rover_state *state);

/* Returns the size of the frame; 0 where the buffer is too short. */
EXPERT_API size_t expert_rover_frame(const struct expert_rover_state *state, uint8_t *frame,
                                     size_t capacity);

#endif
