#include "expert_dagny.h"

#define NEWLINE 0x0Au

/* All frames have four bytes and stand behind a newline or at the beginning. So the last five bytes
   tell all, and none is read again. They are kept so that a newline is 0, as memory is at first. */
static inline uint8_t take(struct expert_dagny_decoder *decoder, uint8_t byte) {
    const uint8_t before = decoder->last[0];
    const uint8_t id = decoder->last[1] ^ NEWLINE;
    const uint8_t value = decoder->last[2] ^ NEWLINE;
    const uint8_t sum = decoder->last[3] ^ NEWLINE;
    decoder->last[0] = decoder->last[1];
    decoder->last[1] = decoder->last[2];
    decoder->last[2] = decoder->last[3];
    decoder->last[3] = byte ^ NEWLINE;
    if (byte != NEWLINE || before != 0 || (id ^ value) != sum) {
        return 0;
    }
    if (id != 'M' && id != 'S' && id != 'R' && id != 'P') {
        return 0;
    }
    decoder->value = value;
    /* What the frame holds is no beginning of another. */
    decoder->last[0] = 1;
    decoder->last[1] = 1;
    decoder->last[2] = 1;
    return id;
}

EXPERT_API uint8_t expert_dagny_push(struct expert_dagny_decoder *decoder, uint8_t byte) {
    return take(decoder, byte);
}

EXPERT_API size_t expert_dagny_feed(struct expert_dagny_decoder *decoder, const uint8_t *data,
                                    size_t size, uint8_t *id) {
    size_t at = 0;
    *id = 0;
    while (at < size && *id == 0) {
        *id = take(decoder, data[at++]);
    }
    return at;
}

EXPERT_API size_t expert_dagny_frame(uint8_t id, uint8_t value, uint8_t *frame, size_t capacity) {
    if (capacity < EXPERT_DAGNY_FRAME) {
        return 0;
    }
    frame[0] = id;
    frame[1] = value;
    frame[2] = id ^ value;
    frame[3] = NEWLINE;
    return EXPERT_DAGNY_FRAME;
}
