#include "expert_tether.h"

#include "expert_crc.h"

enum { OUTSIDE, INSIDE, ESCAPED };

/* What CRC-16/X-25 leaves of a frame with its own two bytes, before it is inverted. */
#define RESIDUE 0xF0B8u

static uint8_t complete(const struct expert_tether_decoder *decoder) {
    const uint8_t id = decoder->content[0];
    uint16_t sum = 0xFFFFu;
    if (decoder->size != (id == EXPERT_TETHER_REPORT  ? EXPERT_TETHER_REPORT_CONTENT
                          : id == EXPERT_TETHER_ALARM ? EXPERT_TETHER_ALARM_CONTENT
                                                      : 0u)) {
        return 0;
    }
    for (uint8_t i = 0; i < decoder->size; i++) {
        sum = expert_ccitt(sum, decoder->content[i]);
    }
    return sum == RESIDUE ? id : 0;
}

/* A flag ends a frame, and may be the one that the next begins with; none stands inside. */
static inline uint8_t take(struct expert_tether_decoder *decoder, uint8_t byte) {
    const uint8_t state = decoder->state;
    const uint8_t size = decoder->size;
    if (byte == 0x7Eu) {
        uint8_t id = 0;
        if (state == INSIDE && size != 0) {
            id = complete(decoder);
        }
        decoder->state = INSIDE;
        decoder->size = 0;
        return id;
    }
    if (state == OUTSIDE) {
        return 0;
    }
    if (byte == 0x7Du && state == INSIDE) {
        decoder->state = ESCAPED;
        return 0;
    }
    decoder->state = OUTSIDE;
    if (state == ESCAPED) {
        byte ^= 0x20u;
        if (byte != 0x7Du && byte != 0x7Eu) {
            return 0;
        }
    }
    if (size < sizeof decoder->content) {
        decoder->state = INSIDE;
        decoder->content[size] = byte;
        decoder->size = (uint8_t)(size + 1u);
    }
    return 0;
}

EXPERT_API uint8_t expert_tether_push(struct expert_tether_decoder *decoder, uint8_t byte) {
    return take(decoder, byte);
}

EXPERT_API size_t expert_tether_feed(struct expert_tether_decoder *decoder, const uint8_t *data,
                                     size_t size, uint8_t *id) {
    size_t at = 0;
    *id = 0;
    while (at < size && *id == 0) {
        *id = take(decoder, data[at++]);
    }
    return at;
}

static uint16_t load(const uint8_t *at) {
    return (uint16_t)(at[0] | (uint16_t)((uint16_t)at[1] << 8));
}

EXPERT_API void expert_tether_read_report(const struct expert_tether_decoder *decoder,
                                          struct expert_tether_report *report) {
    const uint8_t *const payload = &decoder->content[1];
    report->length = load(payload) | (uint32_t)load(&payload[2]) << 16;
    report->speed = (int16_t)load(&payload[4]);
    report->tension = load(&payload[6]);
}

EXPERT_API void expert_tether_read_alarm(const struct expert_tether_decoder *decoder,
                                         struct expert_tether_alarm *alarm) {
    alarm->reason = decoder->content[1];
    alarm->count = load(&decoder->content[2]);
}

static void store(uint8_t *at, uint16_t value) {
    at[0] = (uint8_t)value;
    at[1] = (uint8_t)(value >> 8);
}

/* The content stands at the end of the frame's room; escaping never overtakes it. */
static uint8_t *content_of(uint8_t *frame, uint8_t size) {
    return &frame[1u + size];
}

static size_t finish(uint8_t *frame, uint8_t size) {
    uint8_t *const content = content_of(frame, size);
    uint8_t *to = frame;
    uint16_t sum = 0xFFFFu;
    *to++ = 0x7Eu;
    for (uint8_t i = 0; i < size; i++) {
        uint8_t byte;
        if (i == size - 2u) {
            store(&content[i], (uint16_t)~sum);
        }
        byte = content[i];
        sum = expert_ccitt(sum, byte);
        if (byte == 0x7Eu || byte == 0x7Du) {
            *to++ = 0x7Du;
            byte ^= 0x20u;
        }
        *to++ = byte;
    }
    *to++ = 0x7Eu;
    return (size_t)(to - frame);
}

EXPERT_API size_t expert_tether_frame_report(const struct expert_tether_report *report,
                                             uint8_t *frame, size_t capacity) {
    uint8_t *const content = content_of(frame, EXPERT_TETHER_REPORT_CONTENT);
    if (capacity < EXPERT_TETHER_ROOM(EXPERT_TETHER_REPORT_CONTENT) || report->speed < -3000 ||
        report->speed > 3000) {
        return 0;
    }
    content[0] = EXPERT_TETHER_REPORT;
    store(&content[1], (uint16_t)report->length);
    store(&content[3], (uint16_t)(report->length >> 16));
    store(&content[5], (uint16_t)report->speed);
    store(&content[7], report->tension);
    return finish(frame, EXPERT_TETHER_REPORT_CONTENT);
}

EXPERT_API size_t expert_tether_frame_alarm(const struct expert_tether_alarm *alarm,
                                            uint8_t *frame, size_t capacity) {
    uint8_t *const content = content_of(frame, EXPERT_TETHER_ALARM_CONTENT);
    if (capacity < EXPERT_TETHER_ROOM(EXPERT_TETHER_ALARM_CONTENT)) {
        return 0;
    }
    content[0] = EXPERT_TETHER_ALARM;
    content[1] = alarm->reason;
    store(&content[2], alarm->count);
    return finish(frame, EXPERT_TETHER_ALARM_CONTENT);
}
