#include "expert_atrv.h"

enum {
    IDLE,       /* Between frames. */
    IDLE_ESC,   /* 1B between frames: a start, if 02 follows. */
    DATA,       /* In a frame. */
    DATA_ESC,   /* 1B in a frame. */
    TILDE,      /* 7C in a frame: 1B 01 has to follow. */
    TILDE_ESC
};

/* A start and an end can't occur inside of a frame, so that nothing has to be read again. */
static uint8_t complete(const struct expert_atrv_decoder *decoder) {
    const uint8_t *const content = decoder->content;
    const uint8_t length = content[3];
    uint8_t sum = 0;
    if (decoder->size < 5u || decoder->size != length + 5u) {
        return 0;
    }
    for (uint8_t i = 4; i < decoder->size; i++) {
        sum ^= content[i];
    }
    if (sum != 0) {
        return 0;
    }
    if (content[0] == 0x02u && content[2] == 0x21u && length == 25u) {
        return EXPERT_ATRV_MOTOR;
    }
    if (content[0] == 0x04u && content[2] == 0x02u && length >= 8u) {
        uint8_t rest = (uint8_t)(length - 8u);
        while (rest >= 3u) {
            rest = (uint8_t)(rest - 3u);
        }
        return rest == 0 ? EXPERT_ATRV_SONAR : 0;
    }
    return 0;
}

static inline uint8_t take(struct expert_atrv_decoder *decoder, uint8_t byte) {
    const uint8_t state = decoder->state;
    uint8_t size = decoder->size;
    if (state == DATA) {
        if (byte == 0x1Bu || byte == 0x7Cu) {
            decoder->state = byte == 0x1Bu ? DATA_ESC : TILDE;
            return 0;
        }
    } else {
        if (byte == 0x1Bu) {
            decoder->state = state == TILDE ? TILDE_ESC : IDLE_ESC;
            return 0;
        }
        decoder->state = IDLE;
        if (state == IDLE || state == TILDE) {
            return 0;
        }
        if (byte == 0x02u) {
            decoder->size = 0;
            decoder->state = DATA;
            return 0;
        }
        if (state == DATA_ESC && byte == 0x03u) {
            return complete(decoder);
        }
        if (state == DATA_ESC && byte == 0x00u) {
            byte = 0x1Bu;
        } else if (state == TILDE_ESC && byte == 0x01u) {
            byte = 0x7Cu;
        } else {
            return 0;
        }
        decoder->state = DATA;
    }
    if (size == sizeof decoder->content || (size == 3u && byte > EXPERT_ATRV_PAYLOAD)) {
        decoder->state = IDLE;
        return 0;
    }
    decoder->content[size++] = byte;
    decoder->size = size;
    return 0;
}

EXPERT_API uint8_t expert_atrv_push(struct expert_atrv_decoder *decoder, uint8_t byte) {
    return take(decoder, byte);
}

EXPERT_API size_t expert_atrv_feed(struct expert_atrv_decoder *decoder, const uint8_t *data, size_t size,
                        uint8_t *which) {
    size_t at = 0;
    *which = 0;
    while (at < size && *which == 0) {
        *which = take(decoder, data[at++]);
    }
    return at;
}

static uint32_t load32(const uint8_t *at) {
    uint32_t value = 0;
    for (uint8_t i = 0; i < 4u; i++) {
        value = value << 8 | at[i];
    }
    return value;
}

EXPERT_API void expert_atrv_read_motor(const struct expert_atrv_decoder *decoder,
                            struct expert_atrv_motor *motor) {
    const uint8_t *const payload = &decoder->content[4];
    motor->unknown = load32(payload);
    motor->timestamp = load32(&payload[4]);
    motor->axis = payload[8];
    motor->position = (int32_t)load32(&payload[9]);
    motor->velocity = (int32_t)load32(&payload[13]);
    motor->acceleration = (int32_t)load32(&payload[17]);
    motor->torque = (int32_t)load32(&payload[21]);
}

EXPERT_API void expert_atrv_read_sonar(const struct expert_atrv_decoder *decoder,
                            struct expert_atrv_sonar *sonar) {
    const uint8_t *at = &decoder->content[12];
    const uint8_t *const end = &decoder->content[decoder->size - 1u];
    struct expert_atrv_reading *reading = sonar->readings;
    sonar->unknown = load32(&decoder->content[4]);
    sonar->timestamp = load32(&decoder->content[8]);
    for (; at < end; at += 3, reading++) {
        reading->cluster = at[0];
        reading->distance = (uint16_t)((uint16_t)at[1] << 8 | at[2]);
    }
    sonar->count = (uint8_t)(reading - sonar->readings);
}

static uint8_t *store32(uint8_t *at, uint32_t value) {
    for (uint8_t i = 4; i > 0u; i--) {
        at[i - 1u] = (uint8_t)value;
        value >>= 8;
    }
    return at + 4;
}

/* The content stands at the end of the frame's room; stuffing never overtakes it. */
static uint8_t *content_of(uint8_t *frame, uint8_t size) {
    return &frame[EXPERT_ATRV_ROOM((size_t)size) - 5u - size];
}

static size_t finish(uint8_t *frame, const uint8_t head[4], uint8_t size) {
    uint8_t *const content = content_of(frame, size);
    uint8_t *to = frame;
    uint8_t sum = 0;
    for (uint8_t i = 0; i < size; i++) {
        sum ^= content[4u + i];
    }
    content[4u + size] = sum;
    *to++ = 0x1Bu;
    *to++ = 0x02u;
    for (uint8_t i = 0; i < size + 5u; i++) {
        const uint8_t byte = i < 4u ? head[i] : content[i];
        *to++ = byte;
        if (byte == 0x1Bu) {
            *to++ = 0x00u;
        } else if (byte == 0x7Cu) {
            *to++ = 0x1Bu;
            *to++ = 0x01u;
        }
    }
    *to++ = 0x1Bu;
    *to++ = 0x03u;
    return (size_t)(to - frame);
}

EXPERT_API size_t expert_atrv_frame_motor(const struct expert_atrv_motor *motor, uint8_t number,
                               uint8_t *frame, size_t capacity) {
    const uint8_t head[4] = {0x02u, number, 0x21u, 25u};
    uint8_t *at;
    if (capacity < EXPERT_ATRV_ROOM(25u)) {
        return 0;
    }
    at = content_of(frame, 25u) + 4;
    at = store32(at, motor->unknown);
    at = store32(at, motor->timestamp);
    *at++ = motor->axis;
    at = store32(at, (uint32_t)motor->position);
    at = store32(at, (uint32_t)motor->velocity);
    at = store32(at, (uint32_t)motor->acceleration);
    store32(at, (uint32_t)motor->torque);
    return finish(frame, head, 25u);
}

EXPERT_API size_t expert_atrv_frame_sonar(const struct expert_atrv_sonar *sonar, uint8_t number,
                               uint8_t *frame, size_t capacity) {
    const uint8_t size = (uint8_t)(8u + 3u * sonar->count);
    const uint8_t head[4] = {0x04u, number, 0x02u, size};
    uint8_t *at;
    if (sonar->count > EXPERT_ATRV_READINGS || capacity < EXPERT_ATRV_ROOM((size_t)size)) {
        return 0;
    }
    at = content_of(frame, size) + 4;
    at = store32(at, sonar->unknown);
    at = store32(at, sonar->timestamp);
    for (uint8_t i = 0; i < sonar->count; i++) {
        *at++ = sonar->readings[i].cluster;
        *at++ = (uint8_t)(sonar->readings[i].distance >> 8);
        *at++ = (uint8_t)sonar->readings[i].distance;
    }
    return finish(frame, head, size);
}
