#include "tether.h"

static struct tether_winch_decoder decoder;

static void take(void *user, const struct tether_winch_event *event) {
    (void)user;
    if (event->message == TETHER_MESSAGE_REPORT) {
        tether_report_load(BENCH_MESSAGE, event->payload);
        bench_seen(0);
    } else if (event->message == TETHER_MESSAGE_ALARM) {
        tether_alarm_load(BENCH_MESSAGE, event->payload);
        bench_seen(1);
    }
}

#define LINK(rest) tether_winch##rest
#define NO_MESSAGE TETHER_NO_MESSAGE
#include "use_protogen_link.h"

static inline size_t subject_encode(uint8_t which, uint8_t *frame, size_t capacity) {
    if (which == 0) {
        return tether_report_frame(BENCH_MESSAGE, frame, capacity);
    } else {
        return tether_alarm_frame(BENCH_MESSAGE, frame, capacity);
    }
}

#define FILLED(message) tether_##message
#include "fill_tether.h"
