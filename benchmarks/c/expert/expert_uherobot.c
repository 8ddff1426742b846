#include "expert_uherobot.h"

#define LENGTH EXPERT_UHEROBOT_CONTENT
#define STATUS 1u

/* Neither b nor e is a digit, so that they can't stand inside of a frame. */
static inline bool take(struct expert_uherobot_decoder *decoder, uint8_t byte) {
    const uint8_t at = decoder->at;
    uint8_t *digits;
    if (byte == 'b') {
        decoder->at = 1;
        return false;
    }
    decoder->at = 0;
    if (at == EXPERT_UHEROBOT_FRAME - 1u) {
        return byte == 'e' && decoder->content[0] == LENGTH && decoder->content[1] == STATUS;
    }
    if (at == 0) {
        return false;
    }
    byte = (uint8_t)(byte - '0');
    if (byte > 9u) {
        byte = (uint8_t)(byte - ('A' - '0'));
        if (byte > 5u) {
            return false;
        }
        byte = (uint8_t)(byte + 10u);
    }
    /* The second digit moves the first one up. */
    digits = &decoder->content[(uint8_t)(at - 1u) >> 1];
    *digits = (uint8_t)(*digits << 4 | byte);
    decoder->at = (uint8_t)(at + 1u);
    return false;
}

EXPERT_API bool expert_uherobot_push(struct expert_uherobot_decoder *decoder, uint8_t byte) {
    return take(decoder, byte);
}

EXPERT_API size_t expert_uherobot_feed(struct expert_uherobot_decoder *decoder,
                                       const uint8_t *data, size_t size, bool *complete) {
    size_t at = 0;
    *complete = false;
    while (at < size && !*complete) {
        *complete = take(decoder, data[at++]);
    }
    return at;
}

static int16_t load(const uint8_t *at) {
    return (int16_t)((uint16_t)at[0] << 8 | at[1]);
}

EXPERT_API void expert_uherobot_read(const struct expert_uherobot_decoder *decoder,
                                     struct expert_uherobot_status *status) {
    status->voltage = load(&decoder->content[2]);
    status->current = load(&decoder->content[4]);
    status->temperature = load(&decoder->content[6]);
}

static uint8_t digit(uint8_t value) {
    return (uint8_t)(value < 10u ? '0' + value : 'A' - 10 + value);
}

static uint8_t *put(uint8_t *at, uint8_t byte) {
    at[0] = digit(byte >> 4);
    at[1] = digit(byte & 15u);
    return at + 2;
}

static uint8_t *put16(uint8_t *at, int16_t value) {
    at = put(at, (uint8_t)((uint16_t)value >> 8));
    return put(at, (uint8_t)value);
}

EXPERT_API size_t expert_uherobot_frame(const struct expert_uherobot_status *status,
                                        uint8_t *frame, size_t capacity) {
    if (capacity < EXPERT_UHEROBOT_FRAME) {
        return 0;
    }
    *frame++ = 'b';
    frame = put(frame, LENGTH);
    frame = put(frame, STATUS);
    frame = put16(frame, status->voltage);
    frame = put16(frame, status->current);
    frame = put16(frame, status->temperature);
    *frame = 'e';
    return EXPERT_UHEROBOT_FRAME;
}
