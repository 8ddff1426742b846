/* The probe's attitude and power, by hand: a synchronisation word, a length, and CRC-32. */
#ifndef EXPERT_PROBE_H
#define EXPERT_PROBE_H

#include <stddef.h>
#include <stdint.h>

#include "expert_api.h"

#define EXPERT_PROBE_ATTITUDE 1u
#define EXPERT_PROBE_POWER 2u
#define EXPERT_PROBE_ATTITUDE_FRAME 18u
#define EXPERT_PROBE_POWER_FRAME 13u

struct expert_probe_attitude {
    uint32_t time;
    int16_t roll;
    int16_t pitch;
    int16_t yaw;
};

struct expert_probe_power {
    uint16_t voltage;
    int16_t current;
    uint8_t charge;
};

struct expert_probe_decoder {
    uint8_t size; /* Of what may be a frame, or begin with one. */
    uint8_t due;  /* Size at which it is looked at again. */
    uint8_t at;   /* Where the frame stands that was handed over. */
    uint8_t bytes[EXPERT_PROBE_ATTITUDE_FRAME];
};

/* Takes a byte; returns the identity of the message that it completes, or 0. */
EXPERT_API uint8_t expert_probe_push(struct expert_probe_decoder *decoder, uint8_t byte);
EXPERT_API size_t expert_probe_feed(struct expert_probe_decoder *decoder, const uint8_t *data,
                                    size_t size, uint8_t *id);
EXPERT_API void expert_probe_read_attitude(const struct expert_probe_decoder *decoder,
                                           struct expert_probe_attitude *attitude);
EXPERT_API void expert_probe_read_power(const struct expert_probe_decoder *decoder,
                                        struct expert_probe_power *power);

/* Return the size of the frame; 0 where a value is out of range or the buffer too short. */
EXPERT_API size_t expert_probe_frame_attitude(const struct expert_probe_attitude *attitude,
                                              uint8_t *frame, size_t capacity);
EXPERT_API size_t expert_probe_frame_power(const struct expert_probe_power *power, uint8_t *frame,
                                           size_t capacity);

#endif
