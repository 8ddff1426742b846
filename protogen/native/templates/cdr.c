
/* --- CDR ----------------------------------------------------------------------------------------- */

static const double NOT_A_NUMBER = NAN;

LITTLE(put_lef4, float)

/* Of all NaNs one, that says no more than that. */
static inline uint8_t *put_f4(uint8_t *out, double value) {
    return put_lef4(out, value == value ? (float)value : (float)NAN);
}

static inline uint8_t *put_f8(uint8_t *out, double value) {
    return put_lef8(out, value == value ? value : NOT_A_NUMBER);
}

/* Zeros up to a multiple of `size`. */
static inline uint8_t *put_padding(uint8_t *out, const uint8_t *origin, uint32_t size) {
    memset(out, 0, 8);
    return out + ((uint32_t)(origin - out) & (size - 1U));
}

static inline uint8_t *put_octets(uint8_t *out, const uint8_t *end, const uint8_t *from, uint64_t size) {
    NEED(size);
    memcpy(out, from, size);
    return out + size;
}

/* `count` numbers of `size` bytes each. */
static inline uint8_t *put_run(uint8_t *out, const uint8_t *end, const uint8_t *from, uint64_t count,
                               uint32_t size) {
    uint64_t place;
    NEED(count * size);
    if (IS_LITTLE || size == 1U) {
        memcpy(out, from, count * size);
        return out + count * size;
    }
    for (place = 0; place < count; place++, out += size, from += size) {
        COPY(out, from, size);
    }
    return out;
}

/* `count` characters, of which `stored` lie there; the others are NUL. */
static uint8_t *put_string(uint8_t *out, const uint8_t *end, const uint8_t *from, int64_t stored, int64_t count) {
    uint8_t *const front = out;
    int64_t place;
    NEED(2 * count + 5);
    out += 4;
    for (place = 0; place < count; place++) {
        out = put_utf8(out, place < stored ? from[place] : 0U);
    }
    *out++ = 0;
    (void)put_le4(front, (uint32_t)(out - front) - 4U);
    return out;
}
