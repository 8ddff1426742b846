/* A program that needs everything of a subject, for the linker; it never runs. */
#define BENCH_SIZE 1
#include "bench.h"
#include SUBJECT

#if defined(__AVR__)
#define IN (*(volatile uint8_t *)0x004A)
#define FRAME ((uint8_t *)*(uint8_t *volatile *)0x0048)
#define RESULT (*(volatile uint8_t *)0x003E)
#define WORD (*(volatile uint16_t *)0x0048)
#else
#define IN (*(volatile uint8_t *)0x40001010)
#define FRAME ((uint8_t *)*(uint8_t *volatile *)0x40001014)
#define RESULT (*(volatile uint8_t *)0x40001018)
#define WORD (*(volatile uint16_t *)0x4000101C)
#endif

static void bench_seen(uint8_t which) {
    RESULT = which;
}

int main(void) {
    subject_init();
    for (;;) {
#if defined(SUBJECT_UNFRAMED)
        subject_decode(IN, FRAME, WORD);
#else
        subject_push(IN);
#endif
        if (RESULT != 0) {
            WORD = (uint16_t)subject_encode(IN, FRAME, WORD);
        }
    }
}

#if !defined(__AVR__)
/* What a Cortex-M0 starts with. */
extern uint8_t stack_top[];
__attribute__((section(".vectors"), used)) void *const vectors[2] = {stack_top, (void *)main};
#endif
