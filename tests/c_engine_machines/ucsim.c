/* A driver in the simulators of SDCC: files stand behind a byte of memory, its command and answer. */
#include "driver.h"

#ifdef __SDCC_mcs51
#define MEMORY __xdata
#else
#define MEMORY
#endif
static volatile MEMORY uint8_t __at(0x7FFF) command;

static uint32_t left; /* Bytes of requests: their number stands in front of them. */

static uint8_t next(void) {
    command = 'r';
    return command;
}

int driver_get(void) {
    if (left == 0) {
        return -1;
    }
    left--;
    return next();
}

void driver_put(uint8_t byte) {
    command = 'w';
    command = byte;
}

void driver_done(void) {
}

void main(void) {
    for (uint8_t i = 0; i < 4; i++) {
        left = left << 8 | next();
    }
    driver_run();
    command = 's'; /* Stop. */
}
