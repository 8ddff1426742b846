/* A line on which `drive` comes once; what the board answers has to be the frame of `state`. */
#include <stdint.h>
#include <stdio.h>
#include <string.h>

void setup(void);
void loop(void);
void report(uint16_t millivolts, int16_t sixteenths);

static const uint8_t line[] = {0x08, 0x81, 0xF4, 0x01, 0x0C, 0xFE, 0x5B, 0x69, 0x00};
static size_t at;
static int difference;
static int answered;

int uart_read(void) { return at < sizeof line ? line[at++] : -1; }

void uart_write(const uint8_t *data, size_t size) {
    static const uint8_t state[] = {0x09, 0x82, 0x01, 0xFC, 0x1C, 0xE8, 0xFF, 0xB8, 0xEE, 0x00};
    answered = size == sizeof state && memcmp(data, state, size) == 0;
}

void set_motors(int left, int right) { difference = left - right; }

int main(void) {
    setup();
    loop();
    report(7420, -24);
    return difference == 1000 && answered ? 0 : 1;
}
