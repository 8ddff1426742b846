/* Answers a command byte by byte, by the functions of C. */
#include "matty.h"

volatile uint8_t in, out;
volatile int16_t speed, steer;
static struct matty_pc_decoder decoder;
static struct matty_status status;

static void put(void *user, uint8_t byte) {
    (void)user;
    out = byte;
}

int main(void) {
    matty_pc_decoder_init(&decoder);
    for (;;) {
        const enum matty_message message = matty_pc_decoder_push(&decoder, in);
        if (message == MATTY_MESSAGE_GO) {
            struct matty_pc_event event;
            struct matty_go go;
            matty_pc_decoder_event(&decoder, message, &event);
            matty_go_load(&go, event.payload);
            speed = go.speed;
            steer = go.steer;
            (void)matty_status_send(&status, event.parts.counter, put, NULL);
        }
    }
}
