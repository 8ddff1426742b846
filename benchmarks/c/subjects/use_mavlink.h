/* What the MAVLink subjects have in common: sending, and receiving a byte. */
#include <stdbool.h>
#include <string.h>

#define MAVLINK_USE_CONVENIENCE_FUNCTIONS
#if defined(LINKS)
#define MAVLINK_COMM_NUM_BUFFERS LINKS
#else
#define MAVLINK_COMM_NUM_BUFFERS 1
#endif
#define MAVLINK_NO_SIGN_PACKET
#define MAVLINK_NO_SIGNATURE_CHECK

#include "mavlink_types.h"

static mavlink_system_t mavlink_system = {1, 1};
static uint8_t *out;
static const uint8_t *out_end;
static bool out_full;

#if defined(BENCH_SINK)
static inline void comm_send_ch(mavlink_channel_t channel, uint8_t byte) {
    (void)channel;
    if (out_end == NULL) {
        bench_put(NULL, byte);
    } else if (out == out_end) {
        out_full = true;
    } else {
        *out++ = byte;
    }
}
#else
#define MAVLINK_SEND_UART_BYTES(channel, data, size) send_bytes(data, size)
static inline void send_bytes(const uint8_t *data, size_t size) {
    if (size > (size_t)(out_end - out)) {
        out_full = true;
    } else {
        memcpy(out, data, size);
        out += size;
    }
}
#endif
