#include "uherobot.h"

static struct uherobot_board_decoder decoder;

static void take(void *user, const struct uherobot_board_event *event) {
    (void)user;
    if (event->message == UHEROBOT_MESSAGE_STATUS) {
        uherobot_status_load(BENCH_MESSAGE, event->payload);
        bench_seen(0);
    }
}

#define LINK(rest) uherobot_board##rest
#define NO_MESSAGE UHEROBOT_NO_MESSAGE
#include "use_protogen_link.h"

static inline size_t subject_encode(uint8_t which, uint8_t *frame, size_t capacity) {
    (void)which;
    return uherobot_status_frame(BENCH_MESSAGE, frame, capacity);
}

#define FILLED(message) uherobot_##message
#include "fill_uherobot.h"
