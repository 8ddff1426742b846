/* Matty's status, by hand. */
#ifndef EXPERT_MATTY_H
#define EXPERT_MATTY_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "expert_api.h"

#define EXPERT_MATTY_PAYLOAD 18u
/* Every byte behind the sync may be escaped. */
#define EXPERT_MATTY_ROOM (1u + 2u * (EXPERT_MATTY_PAYLOAD + 4u))

struct expert_matty_status {
    uint8_t status;
    uint8_t mode;
    uint16_t voltage;
    uint16_t current;
    int16_t speed;
    int16_t angle;
    uint16_t encoders[4];
};

struct expert_matty_decoder {
    uint8_t at; /* The next byte: 1 length, 2 counter, 3 command, 4.. payload, 22 sum; 0 none. */
    uint8_t escape;
    uint8_t sum;
    uint8_t content[2u + EXPERT_MATTY_PAYLOAD]; /* counter, command, payload */
};

/* Takes a byte; returns whether it completes a status. */
EXPERT_API bool expert_matty_push(struct expert_matty_decoder *decoder, uint8_t byte);
EXPERT_API size_t expert_matty_feed(struct expert_matty_decoder *decoder, const uint8_t *data, size_t size,
                         bool *complete);
static inline uint8_t expert_matty_counter(const struct expert_matty_decoder *decoder) {
    return decoder->content[0];
}
EXPERT_API void expert_matty_read(const struct expert_matty_decoder *decoder,
                       struct expert_matty_status *status);

/* Returns the size of the frame; 0 where the buffer may be too short. */
EXPERT_API size_t expert_matty_frame(const struct expert_matty_status *status, uint8_t counter,
                          uint8_t *frame, size_t capacity);

#endif
