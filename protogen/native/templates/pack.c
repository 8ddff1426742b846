
/* --- LZ4 ----------------------------------------------------------------------------------------- */

/* Messages are compressed knowing where they begin: most of a message is as in the one of its table in
 * front of it, so that this is the only place where what repeats is looked for. Any LZ4 unpacks it. */

#define LEAST_MATCH 4
#define TAIL 12           /* So many bytes at the end of a block are in no match. */
#define FARTHEST 65535U   /* Bytes that a match may lie back. */
#define MOST (1U << 22)   /* Bytes of a block. */
#define STORED (1U << 31) /* Marks the size of a block that is not compressed. */
#define BLOCK_BYTES 96    /* At most, beside what is in a block and a 255th of that. */

/* Literals, and what repeats behind them. */
struct sequence {
    const uint8_t *literals;
    size_t count;
    size_t distance;
    size_t length; /* 0: there is no sequence. */
};

static inline uint64_t differences(const uint8_t *one, const uint8_t *other) {
    uint64_t first, second;
    memcpy(&first, one, 8);
    memcpy(&second, other, 8);
    return first ^ second;
}

/* How many of the bytes up to `stop` are as those that lie `distance` back. Reads up to 7 bytes more. */
static inline size_t same_bytes(const uint8_t *from, size_t distance, const uint8_t *stop) {
    const uint8_t *at = from;
    for (; at < stop; at += 8) {
        const uint64_t found = differences(at, at - distance);
        if (found != 0) {
#if IS_LITTLE
            at += __builtin_ctzll(found) / 8;
#else
            at += __builtin_clzll(found) / 8;
#endif
            break;
        }
    }
    return (size_t)((at < stop ? at : stop) - from);
}

static inline uint8_t *put_length(uint8_t *out, size_t left) {
    for (; left >= 255U; left -= 255U) {
        *out++ = 255;
    }
    *out++ = (uint8_t)left;
    return out;
}

/* The literals of a sequence, behind its token. */
static inline uint8_t *put_literals(uint8_t *out, const uint8_t *from, size_t count) {
    uint8_t *const token = out++;
    if (count < 15U) {
        *token = (uint8_t)(count << 4);
        memcpy(out, from, 16);
    } else {
        *token = 15U << 4;
        out = put_length(out, count - 15U);
        memcpy(out, from, count);
    }
    return out + count;
}

static inline uint8_t *put_sequence(uint8_t *out, const struct sequence *sequence) {
    uint8_t *const token = out;
    const size_t more = sequence->length - LEAST_MATCH;
    out = put_literals(out, sequence->literals, sequence->count);
    out = put_le2(out, (uint16_t)sequence->distance);
    if (more < 15U) {
        *token |= (uint8_t)more;
        return out;
    }
    *token |= 15U;
    return put_length(out, more - 15U);
}

/* Compress the messages that lie in the room, the first of which is number `first`, and are `size`
 * bytes. Returns where it ends. */
static uint8_t *put_messages(const struct job *job, uint64_t first, size_t size, uint8_t *out) {
    const uint8_t *last[TABLES] = {NULL};
    const uint8_t *const end = job->room + size, *const safe = size < TAIL ? job->room : end - TAIL;
    const uint8_t *anchor = job->room; /* Up to here all is in sequences. */
    struct sequence open = {NULL, 0, 0, 0};
    uint64_t number;
    for (number = first; number < job->entered; number++) {
        const uint8_t *at = job->room + (job->entries[number].place - job->before);
        const uint8_t *stop = number + 1U < job->entered
                                ? job->room + (job->entries[number + 1U].place - job->before) : end;
        const uint8_t *const before = last[job->tables[number]];
        const size_t distance = (size_t)(at - before);
        last[job->tables[number]] = at;
        if (before == NULL || distance > FARTHEST) {
            continue;
        }
        stop = stop < safe ? stop : safe;
        if (open.length != 0 && anchor == at && open.distance == distance) {
            const size_t more = same_bytes(at, distance, stop);
            open.length += more;
            at += more;
            anchor = at;
        }
        while (stop - at >= LEAST_MATCH) {
            uint32_t here, there;
            size_t length;
            memcpy(&here, at, 4);
            memcpy(&there, at - distance, 4);
            if (here != there) {
                at += 1 + ((at - anchor) >> 5);
                continue;
            }
            if (open.length != 0) {
                out = put_sequence(out, &open);
            }
            length = LEAST_MATCH + same_bytes(at + LEAST_MATCH, distance, stop);
            open = (struct sequence){anchor, (size_t)(at - anchor), distance, length};
            at += length;
            anchor = at;
        }
    }
    if (open.length != 0) {
        out = put_sequence(out, &open);
    }
    return put_literals(out, anchor, (size_t)(end - anchor));
}

/* --- checksums of blocks (XXH32) --- */

#define PRIME_1 UINT32_C(2654435761)
#define PRIME_2 UINT32_C(2246822519)
#define PRIME_3 UINT32_C(3266489917)
#define PRIME_4 UINT32_C(668265263)
#define PRIME_5 UINT32_C(374761393)

static inline uint32_t turned(uint32_t value, unsigned bits) {
    return value << bits | value >> (32U - bits);
}

static inline uint32_t le4_at(const uint8_t *at) {
    uint32_t value;
    COPY((uint8_t *)&value, at, 4);
    return value;
}

static uint32_t checksum(const uint8_t *at, size_t size) {
    const uint8_t *const end = at + size;
    uint32_t sum = PRIME_5;
    if (size >= 16U) {
        uint32_t lanes[4] = {PRIME_1 + PRIME_2, PRIME_2, 0, 0U - PRIME_1};
        for (; end - at >= 16; at += 16) {
            unsigned lane;
            for (lane = 0; lane < 4U; lane++) {
                lanes[lane] = turned(lanes[lane] + le4_at(at + 4U * lane) * PRIME_2, 13) * PRIME_1;
            }
        }
        sum = turned(lanes[0], 1) + turned(lanes[1], 7) + turned(lanes[2], 12) + turned(lanes[3], 18);
    }
    sum += (uint32_t)size;
    for (; end - at >= 4; at += 4) {
        sum = turned(sum + le4_at(at) * PRIME_3, 17) * PRIME_4;
    }
    for (; at < end; at++) {
        sum = turned(sum + *at * PRIME_5, 11) * PRIME_1;
    }
    sum = (sum ^ sum >> 15) * PRIME_2;
    sum = (sum ^ sum >> 13) * PRIME_3;
    return sum ^ sum >> 16;
}

/* --- blocks --- */

/* A block of the messages in the room, or several, not compressed, where they are too many. */
static uint8_t *put_block(const struct job *job, uint64_t first, size_t size, uint8_t *out) {
    const uint8_t *from = job->room;
    uint8_t *end = size > MOST ? NULL : put_messages(job, first, size, out + 4);
    if (end != NULL && (size_t)(end - out) < size) {
        const uint32_t packed = (uint32_t)(end - out) - 4U;
        (void)put_le4(out, packed);
        return put_le4(end, checksum(out + 4, packed));
    }
    while (size != 0) {
        const uint32_t some = size < MOST ? (uint32_t)size : MOST;
        out = put_le4(out, some | STORED);
        memcpy(out, from, some);
        out = put_le4(out + some, checksum(out, some));
        from += some;
        size -= some;
    }
    return out;
}

/* Print rows as `protogen_print`, piece by piece until they are `enough` bytes, and compress them.
 *
 * Returns the bytes of the frame of LZ4; 0: the room is too small for the next row. There has to be place
 * for a block more than `enough` bytes. `job->before` are the bytes before they are compressed. */
PROTOGEN_EXPORT size_t protogen_pack(struct job *job, struct rows *tables, size_t count, uint8_t *room, size_t size,
                                     uint8_t *packed, uint64_t enough) {
    /* Blocks of up to 64 KB, 256 KB, 1 MB or 4 MB: the descriptor, and its checksum. */
    static const uint8_t KINDS[4][2] = {{0x40, 0xAD}, {0x50, 0x84}, {0x60, 0x33}, {0x70, 0x72}};
    const unsigned kind = (unsigned)(size > 1U << 16) + (unsigned)(size > 1U << 18) + (unsigned)(size > 1U << 20);
    uint8_t *out = packed;
    job->before = 0;
    out = put_le4(out, UINT32_C(0x184D2204));
    *out++ = 0x70; /* Its first version, blocks that need no others and have checksums. */
    *out++ = KINDS[kind][0];
    *out++ = KINDS[kind][1];
    do {
        const uint64_t first = job->entered;
        const size_t printed = protogen_print(job, tables, count, room, size);
        if (printed == 0) {
            break;
        }
        out = put_block(job, first, printed, out);
        job->before += printed;
    } while (job->before < enough);
    return job->before == 0 ? 0 : (size_t)(put_le4(out, 0) - packed);
}
