/* Answers a command with a frame out of a buffer, by the functions of C. */
#include "rover.h"

volatile uint8_t in, out;
volatile int16_t left, right;
static struct rover_host_decoder decoder;

static void on_event(void *user, const struct rover_host_event *event) {
    (void)user;
    if (event->message == ROVER_MESSAGE_DRIVE) {
        struct rover_drive drive;
        struct rover_state state;
        uint8_t frame[ROVER_STATE_FRAME_ROOM];
        rover_drive_load(&drive, event->payload);
        left = drive.left;
        right = drive.right;
        state.mode = ROVER_STATE_MODE_DRIVING;
        state.battery = 3;
        state.heading = 4;
        const size_t size = rover_state_frame(&state, frame, sizeof frame);
        if (size != 0) {
            for (size_t index = 0; index < size; index++) {
                out = frame[index];
            }
        }
    }
}

int main(void) {
    rover_host_decoder_init(&decoder, on_event, NULL);
    for (;;) {
        rover_host_decoder_push(&decoder, in);
    }
}
