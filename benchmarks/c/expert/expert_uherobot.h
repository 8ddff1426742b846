/* UHERobot's status, by hand: bytes as upper-case digits between b and e. */
#ifndef EXPERT_UHEROBOT_H
#define EXPERT_UHEROBOT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "expert_api.h"

#define EXPERT_UHEROBOT_CONTENT 8u /* length, type, three numbers */
#define EXPERT_UHEROBOT_FRAME (2u + 2u * EXPERT_UHEROBOT_CONTENT)

struct expert_uherobot_status {
    int16_t voltage;
    int16_t current;
    int16_t temperature;
};

struct expert_uherobot_decoder {
    uint8_t at; /* Characters of the frame so far; 0 outside. */
    uint8_t content[EXPERT_UHEROBOT_CONTENT];
};

/* Takes a byte; returns whether it completes a status. */
EXPERT_API bool expert_uherobot_push(struct expert_uherobot_decoder *decoder, uint8_t byte);
EXPERT_API size_t expert_uherobot_feed(struct expert_uherobot_decoder *decoder,
                                       const uint8_t *data, size_t size, bool *complete);
EXPERT_API void expert_uherobot_read(const struct expert_uherobot_decoder *decoder,
                                     struct expert_uherobot_status *status);

/* Returns the size of the frame; 0 where the buffer is too short. */
EXPERT_API size_t expert_uherobot_frame(const struct expert_uherobot_status *status,
                                        uint8_t *frame, size_t capacity);

#endif
