#include "expert_matty.h"

static inline bool take(struct expert_matty_decoder *decoder, uint8_t byte) {
    const uint8_t at = decoder->at;
    if (byte == 0x55u) {
        /* Never inside of a frame. */
        decoder->at = 1;
        decoder->escape = 0;
        decoder->sum = 0;
        return false;
    }
    if (at == 0) {
        return false;
    }
    if (decoder->escape != 0) {
        decoder->escape = 0;
        byte = (uint8_t)~byte;
        if (byte != 0x55u && byte != 0x56u) {
            decoder->at = 0;
            return false;
        }
    } else if (byte == 0x56u) {
        decoder->escape = 1;
        return false;
    }
    decoder->sum = (uint8_t)(decoder->sum + byte);
    decoder->at = (uint8_t)(at + 1u);
    if (at == 1u) {
        if (byte != EXPERT_MATTY_PAYLOAD + 2u) {
            decoder->at = 0;
        }
    } else if (at < 4u + EXPERT_MATTY_PAYLOAD) {
        decoder->content[at - 2u] = byte;
    } else {
        decoder->at = 0;
        return decoder->sum == 0 && decoder->content[1] == (uint8_t)'I';
    }
    return false;
}

EXPERT_API bool expert_matty_push(struct expert_matty_decoder *decoder, uint8_t byte) {
    return take(decoder, byte);
}

EXPERT_API size_t expert_matty_feed(struct expert_matty_decoder *decoder, const uint8_t *data, size_t size,
                         bool *complete) {
    size_t at = 0;
    *complete = false;
    while (at < size && !*complete) {
        *complete = take(decoder, data[at++]);
    }
    return at;
}

static uint16_t load(const uint8_t *at) {
    return (uint16_t)(at[0] | (uint16_t)((uint16_t)at[1] << 8));
}

EXPERT_API void expert_matty_read(const struct expert_matty_decoder *decoder,
                       struct expert_matty_status *status) {
    const uint8_t *const payload = &decoder->content[2];
    status->status = payload[0];
    status->mode = payload[1];
    status->voltage = load(&payload[2]);
    status->current = load(&payload[4]);
    status->speed = (int16_t)load(&payload[6]);
    status->angle = (int16_t)load(&payload[8]);
    for (uint8_t i = 0; i < 4u; i++) {
        status->encoders[i] = load(&payload[10u + 2u * i]);
    }
}

static void store(uint8_t *at, uint16_t value) {
    at[0] = (uint8_t)value;
    at[1] = (uint8_t)(value >> 8);
}

EXPERT_API size_t expert_matty_frame(const struct expert_matty_status *status, uint8_t counter,
                          uint8_t *frame, size_t capacity) {
    /* The content stands at the end of the frame's room; escaping never overtakes it. */
    uint8_t *const content = &frame[EXPERT_MATTY_ROOM - EXPERT_MATTY_PAYLOAD - 3u];
    uint8_t *to = frame;
    uint8_t sum = 0;
    if (capacity < EXPERT_MATTY_ROOM) {
        return 0;
    }
    content[0] = EXPERT_MATTY_PAYLOAD + 2u;
    content[1] = counter;
    content[2] = (uint8_t)'I';
    content[3] = status->status;
    content[4] = status->mode;
    store(&content[5], status->voltage);
    store(&content[7], status->current);
    store(&content[9], (uint16_t)status->speed);
    store(&content[11], (uint16_t)status->angle);
    for (uint8_t i = 0; i < 4u; i++) {
        store(&content[13u + 2u * i], status->encoders[i]);
    }
    *to++ = 0x55u;
    for (uint8_t i = 0; i < EXPERT_MATTY_PAYLOAD + 4u; i++) {
        uint8_t byte = i < EXPERT_MATTY_PAYLOAD + 3u ? content[i] : (uint8_t)(0u - sum);
        sum = (uint8_t)(sum + byte);
        if (byte == 0x55u || byte == 0x56u) {
            *to++ = 0x56u;
            byte = (uint8_t)~byte;
        }
        *to++ = byte;
    }
    return (size_t)(to - frame);
}
