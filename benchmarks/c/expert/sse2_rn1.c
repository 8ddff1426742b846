#include "sse2_rn1.h"

#include <emmintrin.h>

static __m128i load(const uint8_t *at) {
    return _mm_loadu_si128((const __m128i *)at);
}

/* The place of the next identity: bytes of a payload never have their top bit set. */
static size_t identity(const uint8_t *data, size_t at, size_t end) {
    for (; end - at >= 64u; at += 64u) {
        const __m128i a = load(&data[at]);
        const __m128i b = load(&data[at + 16u]);
        const __m128i c = load(&data[at + 32u]);
        const __m128i d = load(&data[at + 48u]);
        if (_mm_movemask_epi8(_mm_or_si128(_mm_or_si128(a, b), _mm_or_si128(c, d))) != 0) {
            break;
        }
    }
    for (; end - at >= 16u; at += 16u) {
        const unsigned tops = (unsigned)_mm_movemask_epi8(load(&data[at]));
        if (tops != 0) {
            return at + (size_t)__builtin_ctz(tops);
        }
    }
    while (at < end && data[at] < 0x80u) {
        at++;
    }
    return at;
}

/* Eight numbers of 14 bits, out of two bytes of seven bits each. */
static __m128i join(__m128i bytes) {
    const __m128i low = _mm_and_si128(bytes, _mm_set1_epi16(0x7F));
    const __m128i high = _mm_and_si128(_mm_srli_epi16(bytes, 1), _mm_set1_epi16(0x3F80));
    return _mm_or_si128(low, high);
}

static void read_gyro(__m128i frame, uint8_t status, struct expert_rn1_gyro *gyro) {
    const __m128i sign = _mm_set1_epi16(0x2000);
    const __m128i numbers = _mm_sub_epi16(_mm_xor_si128(join(frame), sign), sign);
    _Static_assert(sizeof *gyro == 8, "a status in the place of the first number");
    _mm_storel_epi64((__m128i *)(void *)gyro, _mm_insert_epi16(numbers, status, 0));
}

static void read_lidar(const uint8_t *frame, struct expert_rn1_lidar *lidar) {
    lidar->status = frame[1];
    for (size_t i = 0; i < EXPERT_RN1_POINTS; i += 8u) {
        const __m128i numbers = join(load(&frame[2u + 2u * i]));
        _mm_storeu_si128((__m128i *)(void *)&lidar->distances[i], numbers);
    }
}

size_t sse2_rn1_next(const uint8_t *data, size_t size, struct expert_rn1_gyro *gyro,
                     struct expert_rn1_lidar *lidar, uint8_t *id) {
    size_t at = 0;
    *id = 0;
    while (at < size) {
        const uint8_t *const frame = &data[at];
        const size_t left = size - at;
        if (frame[0] == EXPERT_RN1_GYRO && left >= EXPERT_RN1_GYRO_FRAME) {
            const __m128i bytes = _mm_loadl_epi64((const __m128i *)frame);
            const unsigned tops = (unsigned)_mm_movemask_epi8(bytes) & 0xFEu;
            if (tops == 0) {
                read_gyro(bytes, frame[1], gyro);
                *id = EXPERT_RN1_GYRO;
                return at + EXPERT_RN1_GYRO_FRAME;
            }
            at += (size_t)__builtin_ctz(tops);
        } else if (frame[0] == EXPERT_RN1_GYRO || frame[0] == EXPERT_RN1_LIDAR) {
            const size_t whole = frame[0] == EXPERT_RN1_GYRO ? EXPERT_RN1_GYRO_FRAME
                                                             : EXPERT_RN1_LIDAR_FRAME;
            const size_t known = left < whole ? left : whole;
            const size_t next = identity(frame, 1, known);
            if (next == whole) {
                read_lidar(frame, lidar);
                *id = EXPERT_RN1_LIDAR;
                return at + whole;
            }
            if (next == left) {
                return at;
            }
            at += next;
        } else {
            at = identity(data, frame[0] >= 0x80u ? at + 1u : at, size);
        }
    }
    return at;
}
