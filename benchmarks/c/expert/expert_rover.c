#include "expert_rover.h"

#include "expert_crc.h"

/* A zero in front of it does not change CRC-16/KERMIT, whose start is 0; over its own bytes it is 0. */
static EXPERT_APART bool is_state(const struct expert_rover_decoder *decoder) {
    uint16_t sum = 0;
    for (uint8_t i = 1; i < sizeof decoder->content; i++) {
        sum = expert_ccitt(sum, decoder->content[i]);
    }
    return sum == 0 && decoder->content[1] == 0x82u;
}

static inline bool take(struct expert_rover_decoder *decoder, uint8_t byte) {
    const uint8_t size = decoder->size;
    const uint8_t left = decoder->left;
    if (byte == 0) {
        decoder->size = 0;
        decoder->left = 0;
        return size == sizeof decoder->content && left == 0 && is_state(decoder);
    }
    if (size >= sizeof decoder->content) {
        decoder->size = sizeof decoder->content + 1u; /* Too long, up to the next zero. */
        return false;
    }
    if (left == 0) {
        decoder->left = (uint8_t)(byte - 1u);
        byte = 0;
    } else {
        decoder->left = (uint8_t)(left - 1u);
    }
    decoder->content[size] = byte;
    decoder->size = (uint8_t)(size + 1u);
    return false;
}

EXPERT_API bool expert_rover_push(struct expert_rover_decoder *decoder, uint8_t byte) {
    return take(decoder, byte);
}

EXPERT_API size_t expert_rover_feed(struct expert_rover_decoder *decoder, const uint8_t *data,
                                    size_t size, bool *complete) {
    size_t at = 0;
    *complete = false;
    while (at < size && !*complete) {
        *complete = take(decoder, data[at++]);
    }
    return at;
}

EXPERT_API void expert_rover_read(const struct expert_rover_decoder *decoder,
                                  struct expert_rover_state *state) {
    const uint8_t *const payload = &decoder->content[2];
    state->mode = payload[0];
    state->battery = (uint16_t)(payload[1] | (uint16_t)payload[2] << 8);
    state->heading = (int16_t)(payload[3] | (uint16_t)payload[4] << 8);
}

EXPERT_API size_t expert_rover_frame(const struct expert_rover_state *state, uint8_t *frame,
                                     size_t capacity) {
    uint8_t code = 0;
    uint16_t sum = 0;
    if (capacity < EXPERT_ROVER_FRAME) {
        return 0;
    }
    frame[1] = 0x82u;
    frame[2] = state->mode;
    frame[3] = (uint8_t)state->battery;
    frame[4] = (uint8_t)(state->battery >> 8);
    frame[5] = (uint8_t)state->heading;
    frame[6] = (uint8_t)((uint16_t)state->heading >> 8);
    for (uint8_t i = 1; i < 7u; i++) {
        sum = expert_ccitt(sum, frame[i]);
    }
    frame[7] = (uint8_t)sum;
    frame[8] = (uint8_t)(sum >> 8);
    frame[9] = 0;
    /* So short a frame is stuffed where it stands: each zero becomes the code of what follows. */
    for (uint8_t i = 1; i < EXPERT_ROVER_FRAME; i++) {
        if (frame[i] == 0) {
            frame[code] = (uint8_t)(i - code);
            code = i;
        }
    }
    return EXPERT_ROVER_FRAME;
}
