// Does what `matty.c` does, by the header for C++.
#include "matty.hpp"

volatile uint8_t in, out;
volatile int16_t speed, steer;
static matty::pc_decoder decoder;
static matty::status status;

int main() {
    for (;;) {
        decoder.push(in, [](const matty::go &go, const matty::pc_parts &parts) {
            speed = go.speed;
            steer = go.steer;
            (void)matty::send(status, parts.counter, [](uint8_t byte) { out = byte; });
        });
    }
}
