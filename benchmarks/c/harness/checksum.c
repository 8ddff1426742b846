/*
 * Sums up SHORT and LONG bytes, with the marks 1 and 2 around the first and 3 and 4 around the
 * second, and says both results. On a host, prints the bytes of a nanosecond instead.
 */
#include <stddef.h>
#include <stdint.h>

#if defined(HOSTED)
#define _POSIX_C_SOURCE 200809L
#include <stdio.h>
#include <time.h>
#else
#include "marks.h"
#endif

#define T_INLINE static inline __attribute__((always_inline))
#include "sums.h" /* SUM_INIT, sum_run, sum_final */

#define SHORT 32u
#define LONG 96u

#if defined(HOSTED)
static uint8_t data[65536];
#else
static uint8_t data[LONG];
#endif

#if defined(NOTHING)
#define SUM(data, size) 0
#else
#define SUM(data, size) sum_final(sum_run(SUM_INIT, data, size))
#endif

static __attribute__((noinline, noclone)) uint32_t sum_of(const uint8_t *from, size_t size) {
    (void)from;
    (void)size;
    return SUM(from, size);
}

#if !defined(HOSTED)
static void say(uint32_t sum) {
    for (uint8_t index = 0; index < 4u; index++) {
        SAY = (uint8_t)(sum >> (8u * index));
    }
}
#endif

int main(void) {
    size_t index;
    for (index = 0; index < sizeof data; index++) {
        data[index] = (uint8_t)(index * 7u + 1u);
    }
#if defined(HOSTED)
    struct timespec begin, end;
    uint32_t all = 0;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &begin);
    for (index = 0; index < ROUNDS; index++) {
        data[0] = (uint8_t)index;
        all += sum_of(data, sizeof data);
    }
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &end);
    const double spent =
        (double)(end.tv_sec - begin.tv_sec) * 1e9 + (double)(end.tv_nsec - begin.tv_nsec);
    printf("%.6f %lu\n", (double)sizeof data * ROUNDS / spent, (unsigned long)all);
#else
    uint32_t short_sum, long_sum;
    MARK(1);
    short_sum = sum_of(data, SHORT);
    MARK(2);
    say(short_sum);
    MARK(3);
    long_sum = sum_of(data, LONG);
    MARK(4);
    say(long_sum);
    MARK(END);
    for (;;) {
    }
#endif
}
