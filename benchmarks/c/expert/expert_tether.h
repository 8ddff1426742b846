/* The tether's report and alarm, by hand: HDLC's flags and escapes, CRC-16/X-25. */
#ifndef EXPERT_TETHER_H
#define EXPERT_TETHER_H

#include <stddef.h>
#include <stdint.h>

#include "expert_api.h"

#define EXPERT_TETHER_REPORT 0x10u
#define EXPERT_TETHER_ALARM 0x11u
#define EXPERT_TETHER_REPORT_CONTENT 11u /* identity, eight bytes, checksum */
#define EXPERT_TETHER_ALARM_CONTENT 6u
/* Every byte between the flags may be escaped. */
#define EXPERT_TETHER_ROOM(content) (2u + 2u * (content))

struct expert_tether_report {
    uint32_t length;
    int16_t speed;
    uint16_t tension;
};

struct expert_tether_alarm {
    uint8_t reason;
    uint16_t count;
};

struct expert_tether_decoder {
    uint8_t state; /* 0 outside, 1 inside, 2 behind an escape. */
    uint8_t size;
    uint8_t content[EXPERT_TETHER_REPORT_CONTENT];
};

/* Takes a byte; returns the identity of the message that it completes, or 0. */
EXPERT_API uint8_t expert_tether_push(struct expert_tether_decoder *decoder, uint8_t byte);
EXPERT_API size_t expert_tether_feed(struct expert_tether_decoder *decoder, const uint8_t *data,
                                     size_t size, uint8_t *id);
EXPERT_API void expert_tether_read_report(const struct expert_tether_decoder *decoder,
                                          struct expert_tether_report *report);
EXPERT_API void expert_tether_read_alarm(const struct expert_tether_decoder *decoder,
                                         struct expert_tether_alarm *alarm);

/* Return the size of the frame; 0 where a value is out of range or the buffer may be too short. */
EXPERT_API size_t expert_tether_frame_report(const struct expert_tether_report *report,
                                             uint8_t *frame, size_t capacity);
EXPERT_API size_t expert_tether_frame_alarm(const struct expert_tether_alarm *alarm,
                                            uint8_t *frame, size_t capacity);

#endif
