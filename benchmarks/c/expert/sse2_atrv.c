#include "sse2_atrv.h"

#include <emmintrin.h>
#include <stdbool.h>
#include <string.h>

#define HEAD 4u
#define CONTENT (HEAD + EXPERT_ATRV_PAYLOAD + 1u)

static __m128i load(const uint8_t *at) {
    return _mm_loadu_si128((const __m128i *)at);
}

static void store(void *at, __m128i value) {
    _mm_storeu_si128((__m128i *)at, value);
}

/* A bit for each byte that stuffing means: 1B and 7C. */
static unsigned marks(__m128i bytes) {
    const __m128i escape = _mm_cmpeq_epi8(bytes, _mm_set1_epi8(0x1B));
    const __m128i tilde = _mm_cmpeq_epi8(bytes, _mm_set1_epi8(0x7C));
    return (unsigned)_mm_movemask_epi8(_mm_or_si128(escape, tilde));
}

/* The next 1B 02, which always starts a frame; at the end, a 1B may be half of one. */
static size_t start(const uint8_t *data, size_t at, size_t size) {
    for (; size - at > 16u; at += 16u) {
        const __m128i escape = _mm_cmpeq_epi8(load(&data[at]), _mm_set1_epi8(0x1B));
        const __m128i two = _mm_cmpeq_epi8(load(&data[at + 1u]), _mm_set1_epi8(0x02));
        const unsigned found = (unsigned)_mm_movemask_epi8(_mm_and_si128(escape, two));
        if (found != 0) {
            return at + (size_t)__builtin_ctz(found);
        }
    }
    while (at < size && !(data[at] == 0x1Bu && (at + 1u == size || data[at + 1u] == 0x02u))) {
        at++;
    }
    return at;
}

static uint8_t folded(__m128i sums) {
    uint32_t sum;
    sums = _mm_xor_si128(sums, _mm_srli_si128(sums, 8));
    sums = _mm_xor_si128(sums, _mm_srli_si128(sums, 4));
    sum = (uint32_t)_mm_cvtsi128_si32(sums);
    sum ^= sum >> 16;
    return (uint8_t)(sum ^ sum >> 8);
}

/* Four numbers of 32 bits, their bytes the other way round. */
static __m128i swapped(__m128i bytes) {
    const __m128i pairs = _mm_or_si128(_mm_slli_epi16(bytes, 8), _mm_srli_epi16(bytes, 8));
    return _mm_shufflehi_epi16(_mm_shufflelo_epi16(pairs, 0xB1), 0xB1);
}

static uint32_t load32(const uint8_t *at) {
    uint32_t value;
    memcpy(&value, at, sizeof value);
    return __builtin_bswap32(value);
}

static void read_motor(const uint8_t *payload, struct expert_atrv_motor *motor) {
    motor->unknown = load32(payload);
    motor->timestamp = load32(&payload[4]);
    motor->axis = payload[8];
    _Static_assert(offsetof(struct expert_atrv_motor, torque) ==
                       offsetof(struct expert_atrv_motor, position) + 12u,
                   "four numbers in a row");
    store(&motor->position, swapped(load(&payload[9])));
}

/* There are at least four bytes behind the readings. */
static void read_sonar(const uint8_t *payload, uint8_t count, struct expert_atrv_sonar *sonar) {
    const __m128i lane = _mm_cvtsi32_si128(-1);
    const uint8_t *at = &payload[8];
    struct expert_atrv_reading *reading = sonar->readings;
    struct expert_atrv_reading *const end = &reading[count];
    _Static_assert(sizeof *reading == 4, "a cluster, nothing, a distance");
    sonar->unknown = load32(payload);
    sonar->timestamp = load32(&payload[4]);
    sonar->count = count;
    for (; end - reading >= 4; reading += 4, at += 12) {
        const __m128i bytes = load(at);
        const __m128i first = _mm_and_si128(bytes, lane);
        const __m128i second = _mm_and_si128(_mm_slli_si128(bytes, 1), _mm_slli_si128(lane, 4));
        const __m128i third = _mm_and_si128(_mm_slli_si128(bytes, 2), _mm_slli_si128(lane, 8));
        const __m128i fourth = _mm_and_si128(_mm_slli_si128(bytes, 3), _mm_slli_si128(lane, 12));
        const __m128i all =
            _mm_or_si128(_mm_or_si128(first, second), _mm_or_si128(third, fourth));
        const __m128i kept = _mm_and_si128(all, _mm_set1_epi32(0x00FF00FF));
        const __m128i high =
            _mm_and_si128(_mm_slli_epi32(all, 16), _mm_set1_epi32((int)0xFF000000u));
        store(reading, _mm_or_si128(kept, high));
    }
    for (; reading != end; reading++, at += 3) {
        reading->cluster = at[0];
        reading->distance = (uint16_t)((uint16_t)at[1] << 8 | at[2]);
    }
}

/* What the content of a frame is, whose checksum is right. */
static uint8_t take(const uint8_t *content, struct expert_atrv_motor *motor,
                    struct expert_atrv_sonar *sonar) {
    const uint8_t length = content[3];
    if (content[0] == 0x02u && content[2] == 0x21u && length == 25u) {
        read_motor(&content[HEAD], motor);
        return EXPERT_ATRV_MOTOR;
    }
    if (content[0] == 0x04u && content[2] == 0x02u && length >= 8u && (length - 8u) % 3u == 0) {
        read_sonar(&content[HEAD], (uint8_t)((length - 8u) / 3u), sonar);
        return EXPERT_ATRV_SONAR;
    }
    return 0;
}

/* Ones in the first bytes of 16, as many as are wanted: &ones[16 - count]. */
static const uint8_t ones[32] = {0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF,
                                 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF};

/* Whether the checksum of a content that has a head and the length it says is right. */
static bool is_right(const uint8_t *content, size_t size) {
    __m128i sums = _mm_setzero_si128();
    size_t at = HEAD;
    for (; size - at >= 16u; at += 16u) {
        sums = _mm_xor_si128(sums, load(&content[at]));
    }
    sums = _mm_xor_si128(sums, _mm_and_si128(load(&content[at]), load(&ones[16u - (size - at)])));
    return folded(sums) == 0;
}

/*
 * The size of a content without stuffed bytes, whose frame ends where its length says; 0: it has
 * stuffed bytes, or is none. There are 16 bytes behind the greatest frame.
 */
static size_t plain(const uint8_t *content) {
    const size_t size = content[3] + HEAD + 1u;
    size_t at = 0;
    if (size > CONTENT || content[size] != 0x1Bu || content[size + 1u] != 0x03u) {
        return 0;
    }
    for (; size - at >= 16u; at += 16u) {
        if (marks(load(&content[at])) != 0) {
            return 0;
        }
    }
    return (marks(load(&content[at])) & ((1u << (size - at)) - 1u)) == 0 ? size : 0;
}

size_t sse2_atrv_next(const uint8_t *data, size_t size, struct expert_atrv_motor *motor,
                      struct expert_atrv_sonar *sonar, uint8_t *which) {
    size_t at = 0;
    *which = 0;
    for (;;) {
        uint8_t content[CONTENT + 32u]; /* room for whole blocks behind any place */
        size_t taken = 0;
        size_t from;
        bool ended = false;
        if (size - at < 2u || data[at] != 0x1Bu || data[at + 1u] != 0x02u) {
            at = start(data, at, size);
            if (size - at < 2u) {
                return at;
            }
        }
        from = at + 2u;
        if (size - from >= CONTENT + 32u) {
            const size_t whole = plain(&data[from]);
            if (whole != 0) {
                at = from + whole + 2u;
                if (is_right(&data[from], whole)) {
                    *which = take(&data[from], motor, sonar);
                    if (*which != 0) {
                        return at;
                    }
                }
                continue;
            }
        }
        while (!ended) {
            const size_t left = size - from;
            size_t run = 0;
            if (left >= 16u) {
                const __m128i bytes = load(&data[from]);
                store(&content[taken], bytes);
                run = (size_t)__builtin_ctz(marks(bytes) | 0x10000u);
            } else {
                for (; run < left && data[from + run] != 0x1Bu && data[from + run] != 0x7Cu; run++) {
                    content[taken + run] = data[from + run];
                }
            }
            taken += run;
            from += run;
            if (taken > CONTENT) {
                break;
            }
            if (run == 16u) {
                continue;
            }
            if (size - from < 2u) {
                return at;
            }
            if (data[from] == 0x1Bu) {
                ended = data[from + 1u] == 0x03u;
                if (ended) {
                    from += 2u;
                    break;
                }
                if (data[from + 1u] != 0x00u || taken == CONTENT) {
                    break;
                }
                content[taken++] = 0x1Bu;
                from += 2u;
            } else {
                from++;
                if (data[from] != 0x1Bu) {
                    break;
                }
                if (size - from < 2u) {
                    return at;
                }
                if (data[from + 1u] != 0x01u || taken == CONTENT) {
                    break;
                }
                content[taken++] = 0x7Cu;
                from += 2u;
            }
        }
        at = from;
        if (ended && taken > HEAD && taken == content[3] + HEAD + 1u && is_right(content, taken)) {
            *which = take(content, motor, sonar);
            if (*which != 0) {
                return at;
            }
        }
    }
}
