/* A driver on a Cortex-M3 whose requests and answers are files of the host, through semihosting. */
#include "driver.h"

#include <stdio.h>

extern void _start(void);
extern const uint32_t stack_top[];

static void stop(void) {
    for (;;) {
    }
}

/* What the core reads at reset; any fault stops it. */
__attribute__((section(".vectors"), used)) static void (*const vectors[])(void) = {
    (void (*)(void))stack_top, _start, stop, stop, stop, stop, stop,
};

static FILE *requests;
static FILE *answers;

int driver_get(void) {
    return getc(requests);
}

void driver_put(uint8_t byte) {
    putc(byte, answers);
}

void driver_done(void) {
}

int main(void) {
    requests = fopen("requests", "rb");
    answers = fopen("answers", "wb");
    if (requests == NULL || answers == NULL) {
        return 1;
    }
    driver_run();
    return fclose(answers);
}
