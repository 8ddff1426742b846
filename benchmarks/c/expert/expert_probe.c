#include "expert_probe.h"

#include <stdbool.h>
#include <string.h>

#include "expert_crc.h"

/* No frame begins so. Other verdicts are the size at which there is more to see, and 0: a frame. */
#define BAD 0xFFu
#define HEAD 4u

/* What CRC-32 leaves of a frame with its own four bytes, before it is inverted. */
#define RESIDUE 0xDEBB20E3u

/* Over length, identity, payload, and what stands behind them. */
static uint32_t sum_of(const uint8_t *frame, uint8_t size) {
    uint32_t sum = 0xFFFFFFFFu;
    const uint8_t *const end = &frame[size];
    for (frame += 2; frame != end; frame++) {
        sum = expert_crc32(sum, *frame);
    }
    return sum;
}

static uint8_t judge(const uint8_t *bytes, uint8_t size) {
    uint8_t whole;
    if (bytes[0] != 0xAAu || (size > 1u && bytes[1] != 0x55u)) {
        return BAD;
    }
    if (size < HEAD) {
        return HEAD;
    }
    whole = bytes[3] == EXPERT_PROBE_ATTITUDE ? EXPERT_PROBE_ATTITUDE_FRAME
            : bytes[3] == EXPERT_PROBE_POWER  ? EXPERT_PROBE_POWER_FRAME
                                              : 0;
    if (bytes[2] != (uint8_t)(whole - 8u)) {
        return BAD;
    }
    if (size < whole) {
        return whole;
    }
    return sum_of(bytes, whole) == RESIDUE ? 0 : BAD;
}

/* Keeps the bytes from the first place on where a frame can begin. Returns whether one is whole. */
static bool settle(struct expert_probe_decoder *decoder, uint8_t from) {
    const uint8_t size = decoder->size;
    decoder->size = 0;
    decoder->at = from;
    for (; from < size; from++) {
        const uint8_t left = (uint8_t)(size - from);
        const uint8_t verdict = judge(&decoder->bytes[from], left);
        if (verdict == 0) {
            decoder->at = from;
            return true;
        }
        if (verdict != BAD) {
            memmove(decoder->bytes, &decoder->bytes[from], left);
            decoder->size = left;
            decoder->due = verdict;
            break;
        }
    }
    return false;
}

/* A failed attitude can hold a power, which is moved to the end, for what follows it may begin the
   next frame and has to stand in front. */
static void make_room(struct expert_probe_decoder *decoder) {
    const uint8_t behind = (uint8_t)(decoder->at + EXPERT_PROBE_POWER_FRAME);
    const uint8_t left = (uint8_t)(EXPERT_PROBE_ATTITUDE_FRAME - behind);
    uint8_t rest[4];
    memcpy(rest, &decoder->bytes[behind], left);
    memmove(&decoder->bytes[sizeof rest + 1u], &decoder->bytes[decoder->at],
            EXPERT_PROBE_POWER_FRAME);
    memcpy(decoder->bytes, rest, left);
    decoder->size = left;
    (void)settle(decoder, 0);
    decoder->at = sizeof rest + 1u;
}

static EXPERT_APART uint8_t look(struct expert_probe_decoder *decoder) {
    if (!settle(decoder, 0)) {
        return 0;
    }
    if (decoder->at != 0) {
        make_room(decoder);
    }
    return decoder->bytes[decoder->at + 3u];
}

static inline uint8_t take(struct expert_probe_decoder *decoder, uint8_t byte) {
    const uint8_t size = decoder->size;
    if (size == 0) {
        if (byte != 0xAAu) {
            return 0;
        }
        decoder->due = HEAD;
    }
    decoder->bytes[size] = byte;
    decoder->size = (uint8_t)(size + 1u);
    return size + 1u < decoder->due ? 0 : look(decoder);
}

EXPERT_API uint8_t expert_probe_push(struct expert_probe_decoder *decoder, uint8_t byte) {
    return take(decoder, byte);
}

EXPERT_API size_t expert_probe_feed(struct expert_probe_decoder *decoder, const uint8_t *data,
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

EXPERT_API void expert_probe_read_attitude(const struct expert_probe_decoder *decoder,
                                           struct expert_probe_attitude *attitude) {
    const uint8_t *const payload = &decoder->bytes[decoder->at + 4u];
    attitude->time = load(payload) | (uint32_t)load(&payload[2]) << 16;
    attitude->roll = (int16_t)load(&payload[4]);
    attitude->pitch = (int16_t)load(&payload[6]);
    attitude->yaw = (int16_t)load(&payload[8]);
}

EXPERT_API void expert_probe_read_power(const struct expert_probe_decoder *decoder,
                                        struct expert_probe_power *power) {
    const uint8_t *const payload = &decoder->bytes[decoder->at + 4u];
    power->voltage = load(payload);
    power->current = (int16_t)load(&payload[2]);
    power->charge = payload[4];
}

static void store(uint8_t *at, uint16_t value) {
    at[0] = (uint8_t)value;
    at[1] = (uint8_t)(value >> 8);
}

static bool is_within(int16_t value, int16_t most) {
    return value >= -most && value <= most;
}

static size_t finish(uint8_t *frame, uint8_t id, uint8_t size) {
    uint8_t *const end = &frame[size - 4u];
    uint32_t sum;
    frame[0] = 0xAAu;
    frame[1] = 0x55u;
    frame[2] = (uint8_t)(size - 8u);
    frame[3] = id;
    sum = ~sum_of(frame, (uint8_t)(size - 4u));
    store(end, (uint16_t)sum);
    store(&end[2], (uint16_t)(sum >> 16));
    return size;
}

EXPERT_API size_t expert_probe_frame_attitude(const struct expert_probe_attitude *attitude,
                                              uint8_t *frame, size_t capacity) {
    if (capacity < EXPERT_PROBE_ATTITUDE_FRAME || !is_within(attitude->roll, 18000) ||
        !is_within(attitude->pitch, 9000) || !is_within(attitude->yaw, 18000)) {
        return 0;
    }
    store(&frame[4], (uint16_t)attitude->time);
    store(&frame[6], (uint16_t)(attitude->time >> 16));
    store(&frame[8], (uint16_t)attitude->roll);
    store(&frame[10], (uint16_t)attitude->pitch);
    store(&frame[12], (uint16_t)attitude->yaw);
    return finish(frame, EXPERT_PROBE_ATTITUDE, EXPERT_PROBE_ATTITUDE_FRAME);
}

EXPERT_API size_t expert_probe_frame_power(const struct expert_probe_power *power, uint8_t *frame,
                                           size_t capacity) {
    if (capacity < EXPERT_PROBE_POWER_FRAME || power->charge > 100u) {
        return 0;
    }
    store(&frame[4], power->voltage);
    store(&frame[6], (uint16_t)power->current);
    frame[8] = power->charge;
    return finish(frame, EXPERT_PROBE_POWER, EXPERT_PROBE_POWER_FRAME);
}
