#include "rover.h"

static struct rover_board_decoder decoder;

static void take(void *user, const struct rover_board_event *event) {
    (void)user;
    if (event->message == ROVER_MESSAGE_STATE) {
        rover_state_load(BENCH_MESSAGE, event->payload);
        bench_seen(0);
    }
}

#define LINK(rest) rover_board##rest
#define NO_MESSAGE ROVER_NO_MESSAGE
#include "use_protogen_link.h"

static inline size_t subject_encode(uint8_t which, uint8_t *frame, size_t capacity) {
    (void)which;
    return rover_state_frame(BENCH_MESSAGE, frame, capacity);
}

#define FILLED(message) rover_##message
#include "fill_rover.h"
