#include "dagny.h"

static struct dagny_host_decoder decoder;

/* What a command does is the application's: it is told which one came, as beside the expert. */
static void take(void *user, const struct dagny_host_event *event) {
    void *const message = BENCH_MESSAGE;
    (void)user;
#if !defined(BENCH_POLLS)
    if (event->message == DAGNY_NO_MESSAGE) { /* A handler gets all events. */
        return;
    }
#endif
    if (event->message == DAGNY_MESSAGE_MOTOR) {
        dagny_motor_load(message, event->payload);
    } else if (event->message == DAGNY_MESSAGE_STEERING) {
        dagny_steering_load(message, event->payload);
    } else if (event->message == DAGNY_MESSAGE_REFLEX) {
        dagny_reflex_load(message, event->payload);
    } else { /* As beside the expert, nothing else comes here. */
        dagny_power_load(message, event->payload);
    }
    bench_seen((uint8_t)event->message);
}

#define LINK(rest) dagny_host##rest
#define NO_MESSAGE DAGNY_NO_MESSAGE
#include "use_protogen_link.h"

/* Which command is sent varies here: then its identity goes to the function that all of them call,
   as it goes to the expert's. */
static inline size_t subject_encode(uint8_t which, uint8_t *frame, size_t capacity) {
    const uint8_t id = which == 0   ? DAGNY_MOTOR_ID
                       : which == 1 ? DAGNY_STEERING_ID
                       : which == 2 ? DAGNY_REFLEX_ID
                                    : DAGNY_POWER_ID;
    return dagny_host_frame_byte(*(uint8_t *)BENCH_MESSAGE, frame, capacity, id);
}

#include "fill_dagny.h"
