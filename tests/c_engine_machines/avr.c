/* A driver on an ATmega328P: the simulator stands behind three registers. */
#include "driver.h"

#include <avr/interrupt.h>
#include <avr/io.h>
#include <avr/sleep.h>

int driver_get(void) {
    return GPIOR2 != 0 ? GPIOR0 : -1;
}

void driver_put(uint8_t byte) {
    GPIOR1 = byte;
}

void driver_done(void) {
}

int main(void) {
    driver_run();
    cli();
    sleep_cpu(); /* With interrupts off, the simulator ends here. */
    for (;;) {
    }
}
