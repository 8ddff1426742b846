/*
 * What subjects and harnesses share. A subject is a codec behind these functions, all static:
 *
 *   subject_init()                  before the first byte
 *   subject_push(byte)              a byte of the stream; calls bench_seen for each message, with
 *                                   the message decoded into BENCH_MESSAGE
 *   subject_feed(data, size)        bytes of the stream
 *   subject_encode(which, frame, capacity)   frame of the message in BENCH_MESSAGE; 0 if refused
 *   subject_fill(which)             random values into BENCH_MESSAGE, the same for every subject
 *
 * One that frames nothing defines SUBJECT_UNFRAMED and has, in the place of push and feed,
 *
 *   subject_decode(which, payload, size)
 *
 * The RAM of BENCH_MESSAGE is the application's and nobody's cost.
 */
#ifndef BENCH_H
#define BENCH_H

#include <stddef.h>
#include <stdint.h>
#include <string.h>

static void bench_seen(uint8_t which);

#if defined(BENCH_SIZE)
/* Somewhere: the compiler must not know what is there. */
#if defined(__AVR__)
#define BENCH_MESSAGE ((void *)*(uint8_t *volatile *)0x0048)
#else
#define BENCH_MESSAGE ((void *)*(uint8_t *volatile *)0x40001000)
#endif
#else
static union {
    uint32_t aligned;
    uint8_t bytes[BENCH_MESSAGE_SIZE];
} bench_memory;
#define BENCH_MESSAGE ((void *)&bench_memory)
#endif

#if defined(__AVR__) || defined(__ARM_ARCH_6M__)
#define BENCH_SMALL 1
#endif

#if !defined(BENCH_SMALL)
static uint32_t bench_dice = 1;
/* xorshift32: the same values everywhere. */
static uint32_t bench_random(void) {
    bench_dice ^= bench_dice << 13;
    bench_dice ^= bench_dice >> 17;
    bench_dice ^= bench_dice << 5;
    return bench_dice;
}
#define BENCH_FILL 1
#endif

#if defined(BENCH_SMALL)
/* Small machines send a lidar turn byte by byte. */
#define BENCH_SINK 1
#if defined(__AVR__)
#define BENCH_OUT (*(volatile uint8_t *)0x004B) /* GPIOR2 */
#else
#define BENCH_OUT (*(volatile uint8_t *)0x40001008)
#endif
static void bench_put(void *user, uint8_t byte) {
    (void)user;
    BENCH_OUT = byte;
}
#endif

#endif
