/*
 * What the SSE2 subjects have in common: feeding buffers of any size to `whole`, which takes whole
 * messages out of a buffer and returns how many bytes it needs no longer. The expert's own decoder
 * takes single bytes, and encodes.
 */
#define HELD 8192u

static uint8_t held[HELD];
static size_t held_size;

static size_t whole(const uint8_t *data, size_t size);

static void hold(const uint8_t *data, size_t size) {
    memmove(held, data, size);
    held_size = size;
}

static inline void subject_feed(const uint8_t *data, size_t size) {
    while (held_size != 0 && size != 0) {
        const size_t room = HELD - held_size;
        const size_t part = size < room ? size : room;
        size_t used;
        memcpy(&held[held_size], data, part);
        data += part;
        size -= part;
        used = whole(held, held_size + part);
        hold(&held[used], held_size + part - used);
    }
    if (size != 0) {
        const size_t used = whole(data, size);
        hold(&data[used], size - used);
    }
}
