/*
 * What the nanopb subjects have in common. nanopb frames nothing: it is given a payload and which
 * message that is. Where no lidar is sent, streams are plain buffers, by PB_BUFFER_ONLY.
 */
#include "messages.h"

#define SUBJECT_UNFRAMED 1

static inline void subject_init(void) {}
#if !defined(BENCH_SIZE)
static inline void subject_push(uint8_t byte) {
    (void)byte;
}
static inline void subject_feed(const uint8_t *data, size_t size) {
    (void)data;
    (void)size;
}
#endif

static inline void decoded(uint8_t which, const pb_field_t *fields, const uint8_t *payload,
                           size_t size) {
    pb_istream_t stream = pb_istream_from_buffer(payload, size);
    if (pb_decode(&stream, fields, BENCH_MESSAGE)) {
        bench_seen(which);
    }
}

static inline size_t encoded(const pb_field_t *fields, uint8_t *payload, size_t capacity) {
    pb_ostream_t stream = pb_ostream_from_buffer(payload, capacity);
    return pb_encode(&stream, fields, BENCH_MESSAGE) ? stream.bytes_written : 0;
}

#if defined(BENCH_SINK) && !defined(PB_BUFFER_ONLY)
static bool put_bytes(pb_ostream_t *stream, const uint8_t *bytes, size_t size) {
    size_t index;
    (void)stream;
    for (index = 0; index < size; index++) {
        bench_put(NULL, bytes[index]);
    }
    return true;
}

static inline size_t sent(const pb_field_t *fields) {
    pb_ostream_t stream = {put_bytes, NULL, SIZE_MAX, 0};
    return pb_encode(&stream, fields, BENCH_MESSAGE) ? stream.bytes_written : 0;
}
#endif
