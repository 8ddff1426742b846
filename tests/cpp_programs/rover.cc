// Does what `rover.c` does, by the header for C++.
#include "rover.hpp"

volatile uint8_t in, out;
volatile int16_t left, right;
static rover::host_decoder decoder;

static void on_drive(const rover::drive &drive) {
    rover::state state;
    uint8_t frame[rover::frame_room<rover::state>()];
    left = drive.left;
    right = drive.right;
    state.mode = rover::raw(rover::state_mode::driving);
    state.battery = 3;
    state.heading = 4;
    for (uint8_t byte : rover::frame(state, frame)) {
        out = byte;
    }
}

int main() {
    for (;;) {
        decoder.push(in, [](const rover::drive &drive) { on_drive(drive); });
    }
}
