#include "sse2_matty.h"

#include <emmintrin.h>
#include <string.h>

/* Length, counter, command, payload and sum: what stands behind the sync. */
#define CONTENT (EXPERT_MATTY_PAYLOAD + 4u)

static __m128i load(const uint8_t *at) {
    return _mm_loadu_si128((const __m128i *)at);
}

/* A bit for each sync or escape. */
static unsigned marks(__m128i bytes) {
    const __m128i sync = _mm_cmpeq_epi8(bytes, _mm_set1_epi8(0x55));
    const __m128i escape = _mm_cmpeq_epi8(bytes, _mm_set1_epi8(0x56));
    return (unsigned)_mm_movemask_epi8(_mm_or_si128(sync, escape));
}

static size_t sync(const uint8_t *data, size_t at, size_t size) {
    for (; size - at >= 16u; at += 16u) {
        const __m128i equal = _mm_cmpeq_epi8(load(&data[at]), _mm_set1_epi8(0x55));
        const unsigned found = (unsigned)_mm_movemask_epi8(equal);
        if (found != 0) {
            return at + (size_t)__builtin_ctz(found);
        }
    }
    while (at < size && data[at] != 0x55u) {
        at++;
    }
    return at;
}

/* Whether a content, in 16 bytes and 6, is a status, which is read then. */
static bool take(const uint8_t *content, __m128i first, __m128i rest,
                 struct expert_matty_status *status) {
    const __m128i zero = _mm_setzero_si128();
    const __m128i six = _mm_srli_si128(_mm_set1_epi8(-1), 10);
    const __m128i sums =
        _mm_add_epi64(_mm_sad_epu8(first, zero), _mm_sad_epu8(_mm_and_si128(rest, six), zero));
    const int sum = _mm_cvtsi128_si32(_mm_add_epi64(sums, _mm_srli_si128(sums, 8)));
    if ((sum & 0xFF) != 0 || content[2] != (uint8_t)'I') {
        return false;
    }
    _Static_assert(sizeof *status == EXPERT_MATTY_PAYLOAD, "as on the wire");
    memcpy(status, &content[3], EXPERT_MATTY_PAYLOAD);
    return true;
}

size_t sse2_matty_next(const uint8_t *data, size_t size, struct expert_matty_status *status,
                       bool *complete) {
    size_t at = 0;
    *complete = false;
    while (at < size) {
        uint8_t content[CONTENT + 26u]; /* room for whole blocks behind any place */
        size_t taken = 0;
        size_t from = at + 1u;
        if (data[at] != 0x55u) {
            at = sync(data, at, size);
            continue;
        }
        if (from < size && data[from] != EXPERT_MATTY_PAYLOAD + 2u) {
            at = from;
            continue;
        }
        if (size - from >= 32u) {
            const __m128i first = load(&data[from]);
            const __m128i rest = load(&data[from + 16u]);
            const unsigned found = (marks(first) | marks(rest) << 16) & ((1u << CONTENT) - 1u);
            if (found == 0) {
                *complete = take(&data[from], first, rest, status);
                at = from + CONTENT;
                if (*complete) {
                    return at;
                }
                continue;
            }
        }
        while (taken < CONTENT) {
            const size_t left = size - from;
            size_t run = 0;
            if (left >= 16u) {
                const __m128i bytes = load(&data[from]);
                const unsigned found = marks(bytes) | 0x10000u;
                _mm_storeu_si128((__m128i *)(void *)&content[taken], bytes);
                run = (size_t)__builtin_ctz(found);
            } else {
                for (; run < left && data[from + run] != 0x55u && data[from + run] != 0x56u; run++) {
                    content[taken + run] = data[from + run];
                }
            }
            run = run < CONTENT - taken ? run : CONTENT - taken;
            taken += run;
            from += run;
            if (taken == CONTENT) {
                break;
            }
            if (from == size) {
                return at;
            }
            if (data[from] == 0x55u) {
                break;
            }
            if (data[from] == 0x56u) {
                if (from + 1u == size) {
                    return at;
                }
                from++;
                if (data[from] != 0xAAu && data[from] != 0xA9u) {
                    break;
                }
                content[taken++] = (uint8_t)~data[from++];
            }
        }
        at = from;
        if (taken == CONTENT) {
            *complete = take(content, load(content), load(&content[16]), status);
            if (*complete) {
                return at;
            }
        }
    }
    return at;
}
