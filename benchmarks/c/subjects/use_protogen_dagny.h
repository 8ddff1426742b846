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

static inline size_t subject_encode(uint8_t which, uint8_t *frame, size_t capacity) {
    const void *const message = BENCH_MESSAGE;
    switch (which) {
    case 0:
        return dagny_motor_frame(message, frame, capacity);
    case 1:
        return dagny_steering_frame(message, frame, capacity);
    case 2:
        return dagny_reflex_frame(message, frame, capacity);
    default:
        return dagny_power_frame(message, frame, capacity);
    }
}

#include "fill_dagny.h"
