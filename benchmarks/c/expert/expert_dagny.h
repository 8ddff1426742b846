/* Dagny's commands of one byte, by hand: motor, steering, reflex and power. */
#ifndef EXPERT_DAGNY_H
#define EXPERT_DAGNY_H

#include <stddef.h>
#include <stdint.h>

#include "expert_api.h"

#define EXPERT_DAGNY_FRAME 4u

struct expert_dagny_decoder {
    uint8_t last[4]; /* Bytes of the line that may begin a frame, the oldest first. */
    uint8_t value;
};

/* Takes a byte; returns the identity of the command that it completes: M, S, R, P, or 0. */
EXPERT_API uint8_t expert_dagny_push(struct expert_dagny_decoder *decoder, uint8_t byte);
EXPERT_API size_t expert_dagny_feed(struct expert_dagny_decoder *decoder, const uint8_t *data,
                                    size_t size, uint8_t *id);
static inline uint8_t expert_dagny_value(const struct expert_dagny_decoder *decoder) {
    return decoder->value;
}

/* Returns the size of the frame; 0 where the buffer is too short. */
EXPERT_API size_t expert_dagny_frame(uint8_t id, uint8_t value, uint8_t *frame, size_t capacity);

#endif
