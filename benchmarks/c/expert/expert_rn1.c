#include "expert_rn1.h"

static inline uint8_t take(struct expert_rn1_decoder *decoder, uint8_t byte) {
    if (byte >= 0x80u) {
        /* Any identity restarts; one that is not ours is skipped up to the next. */
        decoder->id = byte;
        decoder->at = 0;
        decoder->left = byte == EXPERT_RN1_GYRO    ? EXPERT_RN1_GYRO_FRAME - 1u
                        : byte == EXPERT_RN1_LIDAR ? EXPERT_RN1_LIDAR_FRAME - 1u
                                                   : 0u;
        return 0;
    }
    if (decoder->left == 0) {
        return 0;
    }
    decoder->payload[decoder->at] = byte;
    decoder->at++;
    decoder->left--;
    return decoder->left == 0 ? decoder->id : 0;
}

EXPERT_API uint8_t expert_rn1_push(struct expert_rn1_decoder *decoder, uint8_t byte) {
    return take(decoder, byte);
}

EXPERT_API size_t expert_rn1_feed(struct expert_rn1_decoder *decoder, const uint8_t *data, size_t size,
                       uint8_t *id) {
    size_t at = 0;
    *id = 0;
    while (at < size && *id == 0) {
        *id = take(decoder, data[at++]);
    }
    return at;
}

static uint16_t load(const uint8_t *at) {
    return (uint16_t)(at[0] | (uint16_t)(at[1] << 7));
}

EXPERT_API void expert_rn1_read_gyro(const struct expert_rn1_decoder *decoder, struct expert_rn1_gyro *gyro) {
    const uint8_t *at = &decoder->payload[1];
    gyro->status = decoder->payload[0];
    for (uint8_t i = 0; i < 3u; i++, at += 2) {
        gyro->integral[i] = (int16_t)((load(at) ^ 0x2000u) - 0x2000u);
    }
}

EXPERT_API void expert_rn1_read_lidar(const struct expert_rn1_decoder *decoder,
                           struct expert_rn1_lidar *lidar) {
    const uint8_t *at = &decoder->payload[1];
    lidar->status = decoder->payload[0];
    for (uint16_t i = 0; i < EXPERT_RN1_POINTS; i++, at += 2) {
        lidar->distances[i] = load(at);
    }
}

static uint8_t *store(uint8_t *at, uint16_t value) {
    at[0] = (uint8_t)(value & 0x7Fu);
    at[1] = (uint8_t)((value >> 7) & 0x7Fu);
    return at + 2;
}

EXPERT_API size_t expert_rn1_frame_gyro(const struct expert_rn1_gyro *gyro, uint8_t *frame, size_t capacity) {
    uint8_t *at = &frame[2];
    if (capacity < EXPERT_RN1_GYRO_FRAME || gyro->status > 0x7Fu) {
        return 0;
    }
    for (uint8_t i = 0; i < 3u; i++) {
        if ((uint16_t)((uint16_t)gyro->integral[i] + 0x2000u) >= 0x4000u) {
            return 0;
        }
    }
    frame[0] = EXPERT_RN1_GYRO;
    frame[1] = gyro->status;
    for (uint8_t i = 0; i < 3u; i++) {
        at = store(at, (uint16_t)gyro->integral[i]);
    }
    return EXPERT_RN1_GYRO_FRAME;
}

static bool is_lidar(const struct expert_rn1_lidar *lidar) {
    uint16_t all = 0;
    for (uint16_t i = 0; i < EXPERT_RN1_POINTS; i++) {
        all |= lidar->distances[i];
    }
    return lidar->status <= 0x7Fu && all < 0x4000u;
}

EXPERT_API size_t expert_rn1_frame_lidar(const struct expert_rn1_lidar *lidar, uint8_t *frame,
                              size_t capacity) {
    uint8_t *at = &frame[2];
    if (capacity < EXPERT_RN1_LIDAR_FRAME || !is_lidar(lidar)) {
        return 0;
    }
    frame[0] = EXPERT_RN1_LIDAR;
    frame[1] = lidar->status;
    for (uint16_t i = 0; i < EXPERT_RN1_POINTS; i++) {
        at = store(at, lidar->distances[i]);
    }
    return EXPERT_RN1_LIDAR_FRAME;
}

EXPERT_API bool expert_rn1_send_lidar(const struct expert_rn1_lidar *lidar,
                           void (*put)(void *user, uint8_t byte), void *user) {
    if (!is_lidar(lidar)) {
        return false;
    }
    put(user, EXPERT_RN1_LIDAR);
    put(user, lidar->status);
    for (uint16_t i = 0; i < EXPERT_RN1_POINTS; i++) {
        const uint16_t distance = lidar->distances[i];
        put(user, (uint8_t)(distance & 0x7Fu));
        put(user, (uint8_t)(distance >> 7));
    }
    return true;
}
