/*
 * Decodes and encodes frames, with the marks 1 and 2 around a decoded one, and 3 and 4 around an
 * encoded one. Says how many messages it has seen of each, and how large the encoded one is.
 */
#include "bench.h"
#include "marks.h"
#include SUBJECT

#include "frames.h" /* FRAMES, frame_which, frame_at, frame_size, frame_bytes, all in flash */

static uint8_t seen;
#if defined(SUBJECT_UNFRAMED)
/* Holds a whole payload also before it is decoded: as a receiver has it. */
static uint8_t frame_out[800];
#else
static uint8_t frame_out[256];
#endif

static void bench_seen(uint8_t which) {
    (void)which;
    seen++;
    /* What an application does with a message, compilers do not know here. */
    __asm__ volatile("" ::: "memory");
}

static void decode(uint8_t index) {
    const uint8_t *at = &frame_bytes[pgm_read_word(&frame_at[index])];
    const uint8_t *const end = at + pgm_read_word(&frame_size[index]);
#if defined(SUBJECT_UNFRAMED)
    memcpy_P(frame_out, at, (size_t)(end - at));
    MARK(1);
    subject_decode(pgm_read_byte(&frame_which[index]), frame_out, (size_t)(end - at));
#else
    MARK(1);
    do {
        subject_push(pgm_read_byte(at));
        /* Bytes of a line come one by one: between two of them a decoder is in its memory. */
        __asm__ volatile("" ::: "memory");
        at++;
    } while (at != end);
#endif
    MARK(2);
}

static void encode(uint8_t index) {
    size_t size;
    MARK(3);
    size = subject_encode(pgm_read_byte(&frame_which[index]), frame_out, sizeof frame_out);
    MARK(4);
    SAY = (uint8_t)size;
    SAY = (uint8_t)(size >> 8);
}

int main(void) {
    subject_init();
    decode(0);
    for (uint8_t index = 0; index < FRAMES; index++) {
        seen = 0;
        decode(index);
        SAY = seen;
        encode(index);
    }
    MARK(END);
    for (;;) {
    }
}
