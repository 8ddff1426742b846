#include "probe.h"

static struct probe_sensor_decoder decoder;

static void take(void *user, const struct probe_sensor_event *event) {
    (void)user;
    if (event->message == PROBE_MESSAGE_ATTITUDE) {
        probe_attitude_load(BENCH_MESSAGE, event->payload);
        bench_seen(0);
    } else if (event->message == PROBE_MESSAGE_POWER) {
        probe_power_load(BENCH_MESSAGE, event->payload);
        bench_seen(1);
    }
}

#define LINK(rest) probe_sensor##rest
#define NO_MESSAGE PROBE_NO_MESSAGE
#include "use_protogen_link.h"

static inline size_t subject_encode(uint8_t which, uint8_t *frame, size_t capacity) {
    if (which == 0) {
        return probe_attitude_frame(BENCH_MESSAGE, frame, capacity);
    } else {
        return probe_power_frame(BENCH_MESSAGE, frame, capacity);
    }
}

#define FILLED(message) probe_##message
#include "fill_probe.h"
