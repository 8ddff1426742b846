/* Prints rows of tables as text. Made by protogen for its own use.
 *
 * A row is printed by a program, a list of steps, that `protogen/convert/programs.py` makes: fixed
 * texts, and between them values that lie in columns. Rows of several tables come in the order of
 * their offsets.
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

enum kind {
    END,
    TEXT,     /* The text that lies at `b` of the pool and has `c` bytes. */
    INTEGER,  /* x */
    PLACE,    /* x, counted from the start of the capture. */
    FLOAT,    /* x as Python writes it; where it is no finite number, the first, second or third of
                 the texts from number `b` on: NaN, infinity, minus infinity. */
    NAME,     /* The text number b + x; nothing unless x is below `c`. */
    STRING,   /* At x up to `b` bytes as characters, spelled as table `c` of `escapes` says: y of
                 them, or where a == 0 up to the last that is not NUL. */
    HEX,      /* At x two digits for each of y bytes, or of `b` where a != 0. */
    SPAN,     /* Two digits for each of y bytes from x on in column `a`, which b != 0 makes the
                 bytes of the line. */
    COPY,     /* y bytes from x on in column `a`, as they are. */
    LIST,     /* What is behind it up to NEXT for each element: the first lies at x, the next `b`
                 bytes behind; y of them. a >= 0: a column that has a byte for each element. If
                 there are none, go on at `c`. */
    FIXED,    /* The same with `y.offset` elements. */
    NEXT,
    SWITCH,   /* Go on where one of the `b` cases from number `a` on says that x is, or at `c`. */
    JUMP,     /* Go on at `a`. */
    IF,       /* Go on at `a` where x is 0. */
    ODD,      /* The same, but not if there was a NaN in the row that JSON does not tell. */
    QUOTE,    /* From here on up to UNQUOTE stands one value of CSV. */
    UNQUOTE
};

enum code { U1, I1, U2, I2, U4, I4, U8, I8, F4, F8 };

#define BESIDE (-100) /* The source: what lies beside the element at hand. */
#define DEPTH 16

/* Where a value is: source >= 0: in that column; -1: in the element at hand, -2: in the one around
 * it, and so on, at last in the row. */
struct operand {
    int32_t source;
    int32_t code;
    int64_t offset;
};

struct step {
    int32_t kind;
    int32_t a;
    int64_t b;
    int64_t c;
    struct operand x;
    struct operand y;
};

struct text {
    int64_t place;
    int64_t size;
};

struct choice {
    int64_t value;
    int64_t step;
};

struct printer {
    const struct step *steps;
    const uint8_t *pool; /* Behind it are SLACK bytes more. */
    const struct text *texts;
    const struct choice *choices;
    const uint8_t *escapes; /* Tables: for each character 8 bytes, how many there are and those. */
    const uint8_t *special; /* For each byte, whether a value of CSV that has it needs quotes. */
    char *(*repr)(double value, char format, int precision, int flags, int *type);
    void (*release)(void *memory);
    uint64_t start; /* Is added to every PLACE. */
    uint64_t base;  /* Of the first byte of the line that is at hand. */
    uint8_t nan4[8]; /* The first four: the NaN that JSON's are read as. */
    uint8_t nan8[8];
};

struct table {
    const uint8_t *const *columns;
    const int64_t *strides;
    int64_t rows;
    int64_t next;    /* The row that is printed next. */
    int64_t program; /* Its first step. */
    int64_t offsets; /* The column whose first member is the offset. */
};

struct element {
    const uint8_t *record;
    const uint8_t *beside;
    int64_t left;
    int64_t stride;
    int64_t body;
};

static const char DIGITS[] =
    "0001020304050607080910111213141516171819202122232425262728293031323334353637383940414243444546"
    "4748495051525354555657585960616263646566676869707172737475767778798081828384858687888990919293"
    "949596979899";
static const char HEXADECIMAL[] = "0123456789abcdef";
static const double POWERS[] = {1e0, 1e1, 1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                                1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15};

/* --- values -------------------------------------------------------------------------------------- */

static int64_t value_at(const uint8_t *at, int32_t code) {
    int8_t i1;
    uint16_t u2;
    int16_t i2;
    uint32_t u4;
    int32_t i4;
    int64_t i8;
    switch (code) {
    case U1:
        return *at;
    case I1:
        memcpy(&i1, at, 1);
        return i1;
    case U2:
        memcpy(&u2, at, 2);
        return u2;
    case I2:
        memcpy(&i2, at, 2);
        return i2;
    case U4:
        memcpy(&u4, at, 4);
        return u4;
    case I4:
        memcpy(&i4, at, 4);
        return i4;
    default:
        memcpy(&i8, at, 8);
        return i8;
    }
}

static double double_at(const uint8_t *at, int32_t code) {
    double f8;
    float f4;
    if (code == F4) {
        memcpy(&f4, at, 4);
        return f4;
    }
    memcpy(&f8, at, 8);
    return f8;
}

/* --- texts --------------------------------------------------------------------------------------- */

#define MOST_DIGITS 20
#define SLACK 16 /* So many bytes behind what is printed may be written, too. */

/* Copy a fixed text, in pieces that compilers have instructions for. */
static uint8_t *put_fixed(uint8_t *out, const uint8_t *from, int64_t size) {
    int64_t place = 0;
    do {
        memcpy(out + place, from + place, SLACK);
        place += SLACK;
    } while (place < size);
    return out + size;
}

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

static uint8_t *put_integer(uint8_t *out, int64_t value, int32_t code) {
    const uint64_t minus = value < 0 && code != U8;
    *out = '-';
    return put_natural(out + minus, ((uint64_t)value ^ (0U - minus)) + minus);
}

#define MOST_OF_FLOAT 40

/* A number of at most 15 digits, whose decimal is the only one so short. NULL: it has more.
 *
 * Decimals of 15 digits are further apart than doubles. So if dividing two exact integers, which
 * rounds once, gives the number, there is no other decimal of so few digits, and no shorter one.
 */
static uint8_t *put_short(uint8_t *out, double value) {
#if defined(FLT_EVAL_METHOD) && FLT_EVAL_METHOD == 0
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
#else
    (void)out;
    (void)value;
#endif
    return NULL;
}

static uint8_t *put_text(const struct printer *printer, uint8_t *out, int64_t number) {
    const struct text *const text = &printer->texts[number];
    return put_fixed(out, printer->pool + text->place, text->size);
}

/* The shortest decimal that is read as the same number. NULL where there is no memory. */
static uint8_t *put_double(const struct printer *printer, uint8_t *out, double value, int64_t others) {
    uint8_t *const end = put_short(out, value);
    char *text;
    size_t size;
    if (end != NULL) {
        return end;
    }
    if (value - value != 0.0) {
        return put_text(printer, out, others + (value > 0.0 ? 1 : value < 0.0 ? 2 : 0));
    }
    text = printer->repr(value, 'r', 0, 2, NULL); /* 2: ".0" behind integers. */
    if (text == NULL) {
        return NULL;
    }
    size = strlen(text);
    memcpy(out, text, size);
    printer->release(text);
    return out + size;
}

static uint8_t *put_hex(uint8_t *out, const uint8_t *at, size_t size) {
    size_t place;
    for (place = 0; place < size; place++) {
        *out++ = (uint8_t)HEXADECIMAL[at[place] >> 4];
        *out++ = (uint8_t)HEXADECIMAL[at[place] & 15U];
    }
    return out;
}

/* Put the value of CSV that begins at `mark` in quotes if it needs some. NULL: there is no room. */
static uint8_t *quote(const struct printer *printer, uint8_t *mark, uint8_t *out, const uint8_t *end) {
    size_t more = 2;
    int needed = 0;
    const uint8_t *from;
    uint8_t *to;
    for (from = mark; from != out; from++) {
        needed |= printer->special[*from];
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

/* --- rows ---------------------------------------------------------------------------------------- */

static const uint8_t *find(const struct table *table, const struct element *at, const struct operand *operand) {
    if (operand->source >= 0) {
        return table->columns[operand->source] + table->next * table->strides[operand->source] + operand->offset;
    }
    if (operand->source == BESIDE) {
        return at->beside;
    }
    return at[1 + operand->source].record + operand->offset;
}

#define VALUE(operand) value_at(find(table, at, &(operand)), (operand).code)
#define NEED(size)                              \
    do {                                        \
        if ((uint64_t)(end - out) < (uint64_t)(size)) { \
            return NULL;                        \
        }                                       \
    } while (0)

/* The next row of a table, and where it ends. NULL: there is no room for it. */
static uint8_t *put_row(const struct printer *printer, const struct table *table, uint8_t *out, const uint8_t *end) {
    struct element elements[DEPTH];
    struct element *at = elements;
    const struct step *step = &printer->steps[table->program];
    uint8_t *mark = out;
    int odd = 0;
    at->record = table->columns[0] + table->next * table->strides[0];
    at->beside = NULL;
    for (;;) {
        switch (step->kind) {
        case END:
            return out;
        case TEXT:
            NEED(step->c);
            out = put_fixed(out, printer->pool + step->b, step->c);
            break;
        case INTEGER:
            NEED(MOST_DIGITS + 1);
            out = put_integer(out, VALUE(step->x), step->x.code);
            break;
        case PLACE:
            NEED(MOST_DIGITS + 1);
            out = put_natural(out, (uint64_t)VALUE(step->x) + printer->start);
            break;
        case FLOAT: {
            const uint8_t *const from = find(table, at, &step->x);
            const double value = double_at(from, step->x.code);
            NEED(MOST_OF_FLOAT);
            if (value != value) {
                odd |= memcmp(from, step->x.code == F4 ? printer->nan4 : printer->nan8, step->x.code == F4 ? 4 : 8) != 0;
            }
            out = put_double(printer, out, value, step->b);
            if (out == NULL) {
                return NULL;
            }
            break;
        }
        case NAME: {
            const int64_t number = VALUE(step->x);
            if (number >= 0 && number < step->c) {
                NEED(printer->texts[step->b + number].size);
                out = put_text(printer, out, step->b + number);
            }
            break;
        }
        case STRING: {
            const uint8_t *const from = find(table, at, &step->x);
            const uint8_t *const escapes = &printer->escapes[2048 * step->c];
            int64_t stored = step->b, size, place;
            while (stored > 0 && from[stored - 1] == 0) {
                stored--;
            }
            size = step->a != 0 ? VALUE(step->y) : stored;
            NEED(8 * size);
            for (place = 0; place < size; place++) {
                const uint8_t *const escape = &escapes[8U * (place < stored ? from[place] : 0U)];
                memcpy(out, &escape[1], 7);
                out += escape[0];
            }
            break;
        }
        case HEX: {
            const int64_t size = step->a != 0 ? step->b : VALUE(step->y);
            NEED(2 * size);
            out = put_hex(out, find(table, at, &step->x), (size_t)size);
            break;
        }
        case SPAN: {
            const int64_t size = VALUE(step->y);
            const uint64_t from = (uint64_t)VALUE(step->x) - (step->b != 0 ? printer->base : 0U);
            NEED(2 * size);
            out = put_hex(out, table->columns[step->a] + from, (size_t)size);
            break;
        }
        case COPY: {
            const int64_t size = VALUE(step->y);
            NEED(size);
            memcpy(out, table->columns[step->a] + VALUE(step->x), (size_t)size);
            out += size;
            break;
        }
        case LIST:
        case FIXED: {
            const uint8_t *const first = find(table, at, &step->x);
            const int64_t count = step->kind == FIXED ? step->y.offset : VALUE(step->y);
            if (count <= 0) {
                step = &printer->steps[step->c];
                continue;
            }
            at++;
            at->record = first;
            at->beside = step->a < 0 ? NULL : table->columns[step->a] + table->next * table->strides[step->a];
            at->left = count;
            at->stride = step->b;
            at->body = step - printer->steps + 1;
            break;
        }
        case NEXT:
            if (--at->left > 0) {
                NEED(2);
                *out++ = ',';
                *out++ = ' ';
                at->record += at->stride;
                at->beside += at->beside != NULL;
                step = &printer->steps[at->body];
                continue;
            }
            at--;
            break;
        case SWITCH: {
            const int64_t value = VALUE(step->x);
            const struct choice *choice = &printer->choices[step->a];
            const struct choice *const last = choice + step->b;
            while (choice != last && choice->value != value) {
                choice++;
            }
            step = &printer->steps[choice == last ? step->c : choice->step];
            continue;
        }
        case JUMP:
            step = &printer->steps[step->a];
            continue;
        case IF:
        case ODD:
            if (VALUE(step->x) == 0 && !(step->kind == ODD && odd)) {
                step = &printer->steps[step->a];
                continue;
            }
            break;
        case QUOTE:
            mark = out;
            break;
        case UNQUOTE:
            out = quote(printer, mark, out, end);
            if (out == NULL) {
                return NULL;
            }
            break;
        default:
            return NULL;
        }
        step++;
    }
}

static uint64_t offset_of(const struct table *table) {
    uint64_t offset;
    memcpy(&offset, table->columns[table->offsets] + table->next * table->strides[table->offsets], 8);
    return offset;
}

/* Print rows of all tables by their offsets, as many as there is room for. Returns the bytes. */
PROTOGEN_EXPORT size_t protogen_print(const struct printer *printer, struct table *tables, size_t count, uint8_t *room, size_t size) {
    const uint8_t *const end = size < SLACK ? room : room + (size - SLACK);
    uint8_t *out = room;
    for (;;) {
        struct table *first = NULL;
        uint64_t least = UINT64_MAX, limit = UINT64_MAX;
        size_t number;
        for (number = 0; number < count; number++) {
            struct table *const table = &tables[number];
            if (table->next < table->rows) {
                const uint64_t offset = offset_of(table);
                if (first == NULL || offset < least) {
                    limit = least;
                    least = offset;
                    first = table;
                } else if (offset < limit) {
                    limit = offset;
                }
            }
        }
        if (first == NULL) {
            return (size_t)(out - room);
        }
        do {
            uint8_t *const behind = put_row(printer, first, out, end);
            if (behind == NULL) {
                return (size_t)(out - room);
            }
            out = behind;
            first->next++;
        } while (first->next < first->rows && offset_of(first) < limit);
    }
}
