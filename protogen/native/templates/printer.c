/* What prints rows of tables, as text or as messages of MCAP. Made by protogen for its own use.
 *
 * In front of this stand macros for what depends on the schema. Behind it follow functions that print
 * the rows of one table each, and `put_row`, which calls them. They return where the text ends, or NULL
 * where there is no room for it.
 */
#include <float.h>
#include <math.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#ifdef _WIN32
#define PROTOGEN_EXPORT __declspec(dllexport)
#else
#define PROTOGEN_EXPORT __attribute__((visibility("default")))
#endif

#if !defined(FLT_EVAL_METHOD) || FLT_EVAL_METHOD != 0
#error "doubles are computed with another precision"
#endif

/* A message of MCAP as an index has it. */
struct entry {
    uint64_t time;
    uint64_t place;
};

/* What is printed at once. All members have eight bytes, or are pointers. */
struct job {
    const uint8_t *line; /* The bytes of the capture from offset `base` on. */
    uint64_t base;
    char *(*repr)(double value, char format, int precision, int flags, int *type);
    void (*release)(void *memory);
    const uint8_t *room;   /* Where what is printed begins. */
    struct entry *entries; /* Of the messages of MCAP, */
    uint32_t *tables;      /* their tables, */
    uint64_t entered;      /* and how many there are. */
};

/* The rows of a table. Every row begins with the offset of its event. */
struct rows {
    const uint8_t *rows;
    uint64_t stride;
    uint64_t count;
    uint64_t next;  /* The row that is printed next. */
    uint64_t table; /* The number of its function. */
    const uint8_t *differs; /* NULL: no row does. */
    const int64_t *times;   /* NULL: none is known. */
    const uint8_t *timed;
    const uint8_t *payloads;
};

static const char DIGITS[] =
    "0001020304050607080910111213141516171819202122232425262728293031323334353637383940414243444546"
    "4748495051525354555657585960616263646566676869707172737475767778798081828384858687888990919293"
    "949596979899";
static const char HEXADECIMAL[] = "0123456789abcdef";
static const double POWERS[] = {1e0, 1e1, 1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                                1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15};

/* --- values -------------------------------------------------------------------------------------- */

#define READER(code, type, result)                    \
    static inline result code##_at(const uint8_t *at) { \
        type value;                                   \
        memcpy(&value, at, sizeof value);             \
        return (result)value;                         \
    }

READER(u1, uint8_t, uint64_t)
READER(u2, uint16_t, uint64_t)
READER(u4, uint32_t, uint64_t)
READER(u8, uint64_t, uint64_t)
READER(i1, int8_t, int64_t)
READER(i2, int16_t, int64_t)
READER(i4, int32_t, int64_t)
READER(i8, int64_t, int64_t)
READER(f4, float, double)
READER(f8, double, double)

/* Whether a float is another NaN than the one that JSON's are read as. */
static inline int is_odd_f4(const uint8_t *at) {
    const uint64_t bits = u4_at(at);
    return (bits & UINT64_C(0x7FFFFFFF)) > UINT64_C(0x7F800000) && bits != UINT64_C(0x7FC00000);
}

static inline int is_odd_f8(const uint8_t *at) {
    const uint64_t bits = u8_at(at);
    return (bits & UINT64_C(0x7FFFFFFFFFFFFFFF)) > UINT64_C(0x7FF0000000000000)
        && bits != UINT64_C(0x7FF8000000000000);
}

/* value x scale + offset, both rounded. */
static inline double scaled_float(double value, double scale, double offset) {
    const volatile double product = value * scale; /* Else they could be made one, which rounds once. */
    return product + offset;
}

/* (value x times + plus) / over, rounded once. */
static double scaled_integer(__int128 value, int64_t times, int64_t plus, uint64_t over) {
    const __int128 sum = value * times + plus;
    unsigned __int128 left = sum < 0 ? -(unsigned __int128)sum : (unsigned __int128)sum;
    unsigned __int128 quotient;
    double found;
    int shift = 0;
    if (left == 0) {
        return 0.0;
    }
    while ((left >> 127) == 0) {
        left <<= 1;
        shift++;
    }
    /* It has at least 65 bits; the last says whether there are more. */
    quotient = left / over;
    if (left % over != 0) {
        quotient |= 1U;
    }
    found = (double)quotient / (double)((unsigned __int128)1 << shift);
    return sum < 0 ? -found : found;
}

/* --- texts --------------------------------------------------------------------------------------- */

#define SLACK 16 /* So many bytes behind what is printed may be written, too. */

#define NEED(size)                                      \
    do {                                                \
        if ((uint64_t)(end - out) < (uint64_t)(size)) { \
            return NULL;                                \
        }                                               \
    } while (0)

#define OR_FAIL(put)       \
    do {                   \
        out = put;         \
        if (out == NULL) { \
            return NULL;   \
        }                  \
    } while (0)

#define PUT(text)                            \
    do {                                     \
        memcpy(out, text, sizeof(text) - 1U); \
        out += sizeof(text) - 1U;            \
    } while (0)

/* Four digits. */
static uint8_t *put_four(uint8_t *out, uint32_t value) {
    const uint32_t front = value / 100U;
    memcpy(out, &DIGITS[2U * front], 2);
    memcpy(out + 2, &DIGITS[2U * (value - front * 100U)], 2);
    return out + 4;
}

/* Up to four digits, without zeros in front. How many there are is not guessed by a branch. */
static uint8_t *put_few(uint8_t *out, uint32_t value) {
    const unsigned none = (unsigned)(value < 10U) + (unsigned)(value < 100U) + (unsigned)(value < 1000U);
#if defined(__BYTE_ORDER__) && __BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__
    const uint32_t front = value / 100U;
    uint16_t high, low;
    uint32_t digits;
    memcpy(&high, &DIGITS[2U * front], 2);
    memcpy(&low, &DIGITS[2U * (value - front * 100U)], 2);
    digits = ((uint32_t)low << 16 | high) >> (8U * none);
    memcpy(out, &digits, 4);
#else
    uint8_t digits[8] = {0};
    put_four(digits, value);
    memcpy(out, &digits[none], 4);
#endif
    return out + (4U - none);
}

static uint8_t *put_natural(uint8_t *out, uint64_t value) {
    uint32_t back;
    if (value < 10000U) {
        return put_few(out, (uint32_t)value);
    }
    if (value < 100000000U) {
        const uint32_t front = (uint32_t)value / 10000U;
        return put_four(put_few(out, front), (uint32_t)value - front * 10000U);
    }
    out = put_natural(out, value / 100000000U);
    back = (uint32_t)(value % 100000000U);
    return put_four(put_four(out, back / 10000U), back % 10000U);
}

static uint8_t *put_integer(uint8_t *out, int64_t value) {
    const uint64_t minus = value < 0;
    *out = '-';
    return put_natural(out + minus, ((uint64_t)value ^ (0U - minus)) + minus);
}

/* A number of at most 15 digits, whose decimal is the only one so short. NULL: it has more.
 *
 * Decimals of 15 digits are further apart than doubles. So if dividing two exact integers, which
 * rounds once, gives the number, there is no other decimal of so few digits, and no shorter one.
 */
static uint8_t *put_short(uint8_t *out, double value) {
    const double absolute = fabs(value);
    int digits;
    if (!(absolute >= 1e-4 && absolute < 1e15)) {
        return NULL;
    }
    for (digits = 0; digits <= 15; digits++) {
        const double scaled = absolute * POWERS[digits];
        uint64_t whole, unit, front;
        int place;
        if (scaled >= 1e15) {
            return NULL;
        }
        whole = (uint64_t)(scaled + 0.5);
        if ((double)whole / POWERS[digits] != absolute) {
            continue;
        }
        if (value < 0.0) {
            *out++ = '-';
        }
        unit = (uint64_t)POWERS[digits];
        front = whole / unit;
        out = put_natural(out, front);
        *out++ = '.';
        if (digits == 0) {
            *out++ = '0';
            return out;
        }
        whole -= front * unit;
        for (place = digits - 1; place >= 0; place--) {
            out[place] = (uint8_t)('0' + whole % 10U);
            whole /= 10U;
        }
        return out + digits;
    }
    return NULL;
}

/* The shortest decimal that is read as the same number, or the text for what is no finite number. NULL
 * where there is no memory. */
static uint8_t *put_double(const struct job *job, uint8_t *out, double value, const char *nan, const char *infinity,
                           const char *minus_infinity) {
    uint8_t *const end = put_short(out, value);
    char *text;
    size_t size;
    if (end != NULL) {
        return end;
    }
    if (value - value != 0.0) {
        const char *const other = value > 0.0 ? infinity : value < 0.0 ? minus_infinity : nan;
        size = strlen(other);
        memcpy(out, other, size);
        return out + size;
    }
    text = job->repr(value, 'r', 0, 2, NULL); /* 2: ".0" behind integers. */
    if (text == NULL) {
        return NULL;
    }
    size = strlen(text);
    memcpy(out, text, size);
    job->release(text);
    return out + size;
}

static uint8_t *put_hex(uint8_t *out, const uint8_t *end, const uint8_t *from, uint64_t size) {
    uint64_t place;
    NEED(2U * size);
    for (place = 0; place < size; place++) {
        *out++ = (uint8_t)HEXADECIMAL[from[place] >> 4];
        *out++ = (uint8_t)HEXADECIMAL[from[place] & 15U];
    }
    return out;
}

/* How many characters there are up to the last one that is not NUL. */
static int64_t text_size(const uint8_t *from, int64_t room) {
    while (room > 0 && from[room - 1] == 0) {
        room--;
    }
    return room;
}

static uint8_t *put_utf8(uint8_t *out, uint8_t character) {
    if (character >= 0x80U) {
        *out++ = (uint8_t)(0xC0U | character >> 6);
        character = (uint8_t)(0x80U | (character & 0x3FU));
    }
    *out++ = character;
    return out;
}

static uint8_t *put_escape(uint8_t *out, uint8_t character) {
    PUT("\\u00");
    *out++ = (uint8_t)HEXADECIMAL[character >> 4];
    *out++ = (uint8_t)HEXADECIMAL[character & 15U];
    return out;
}

/* A character as JSON has it. */
static uint8_t *put_quotable(uint8_t *out, uint8_t character, int is_ascii) {
    static const char SHORT[] = "\"\"\\\\\bb\ff\nn\rr\tt";
    const char *escape;
    for (escape = SHORT; *escape != '\0'; escape += 2) {
        if (character == (uint8_t)*escape) {
            *out++ = '\\';
            *out++ = (uint8_t)escape[1];
            return out;
        }
    }
    if (character < 0x20U || (is_ascii && character >= 0x7FU)) {
        return put_escape(out, character);
    }
    return put_utf8(out, character);
}

/* `count` characters, of which `stored` lie there; the others are NUL. */
#define PUTTER(name, put)                                                                                      \
    static uint8_t *name(uint8_t *out, const uint8_t *end, const uint8_t *from, int64_t stored, int64_t count) { \
        int64_t place;                                                                                         \
        NEED(6 * count);                                                                                       \
        for (place = 0; place < count; place++) {                                                              \
            const uint8_t character = place < stored ? from[place] : 0U;                                       \
            out = put;                                                                                         \
        }                                                                                                      \
        return out;                                                                                            \
    }

PUTTER(put_json, put_quotable(out, character, 0))
PUTTER(put_json_ascii, put_quotable(out, character, 1))
PUTTER(put_plain, put_utf8(out, character))

/* Put the value of CSV that begins at `mark` in quotes if it needs some. NULL: there is no room. */
static uint8_t *put_quotes(uint8_t *mark, uint8_t *out, const uint8_t *end) {
    size_t more = 2;
    int needed = 0;
    const uint8_t *from;
    uint8_t *to;
    for (from = mark; from != out; from++) {
        needed |= NEEDS_QUOTES(*from);
        more += *from == '"';
    }
    if (!needed) {
        return out;
    }
    if ((size_t)(end - out) < more) {
        return NULL;
    }
    from = out;
    to = out + more;
    *--to = '"';
    while (from != mark) {
        *--to = *--from;
        if (*from == '"') {
            *--to = '"';
        }
    }
    *mark = '"';
    return out + more;
}

/* --- numbers in little-endian order -------------------------------------------------------------- */

#if defined(__BYTE_ORDER__) && __BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__
#define IS_LITTLE 1
#define COPY(to, from, size) memcpy(to, from, size)
#else
#define IS_LITTLE 0
#define COPY(to, from, size) copy_reversed(to, from, size)

static inline void copy_reversed(uint8_t *to, const void *from, size_t size) {
    const uint8_t *const bytes = from;
    size_t place;
    for (place = 0; place < size; place++) {
        to[place] = bytes[size - 1U - place];
    }
}
#endif

#define LITTLE(name, type)                                   \
    static inline uint8_t *name(uint8_t *out, type value) { \
        COPY(out, &value, sizeof value);                     \
        return out + sizeof value;                           \
    }

LITTLE(put_le2, uint16_t)
LITTLE(put_le4, uint32_t)
LITTLE(put_le8, uint64_t)
LITTLE(put_lef8, double)

/* --- MCAP ---------------------------------------------------------------------------------------- */

static inline uint64_t offset_of(const struct rows *rows) {
    return u8_at(rows->rows + (size_t)rows->next * rows->stride);
}

/* When the next row was logged: at its time or, without one, when the line had come to its `end`. The
 * log knows no time before 1970. */
static inline uint64_t log_time(const struct rows *rows, uint64_t end) {
    if (rows->times != NULL && rows->timed[rows->next]) {
        return rows->times[rows->next] < 0 ? 0U : (uint64_t)rows->times[rows->next];
    }
    return LINE_TIME(end);
}

/* Put what stands in front of the message of a frame of `size` bytes, which ends at `out`, and enter it
 * into the index. */
static inline void put_envelope(struct job *job, const struct rows *rows, uint8_t *at, const uint8_t *out,
                                uint32_t channel, uint64_t size) {
    const uint64_t offset = offset_of(rows), time = log_time(rows, offset + size);
    struct entry *const entry = &job->entries[job->entered];
    entry->time = time;
    entry->place = (uint64_t)(at - job->room);
    job->tables[job->entered++] = (uint32_t)rows->table;
    *at = 5;
    at = put_le8(at + 1, (uint64_t)(out - at) - 9U);
    at = put_le4(put_le2(at, (uint16_t)channel), (uint32_t)offset);
    (void)put_le8(put_le8(at, time), time);
}
