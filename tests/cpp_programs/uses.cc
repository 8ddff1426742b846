// What the header for C++ takes and gives, with and without the library of C++. Exits with 0.
#include "rover.hpp"

#include <array>
#include <cstring>
#include <vector>
#if __cplusplus >= 202002L
#include <span>
#endif

static_assert(rover::state_mode(1) == rover::state_mode::driving, "");
static_assert(rover::raw(rover::state_mode::blocked) == 2, "");
static_assert(rover::message_of<rover::drive>() == rover::message::drive, "");
// By hand: 16 / 16 deg; -1.03 * 16 = -16.48, and 3.2814 / 0.001 = 3281.4; what is too great stays below.
static_assert(rover::state_heading_physical(16) == 1.0F, "");
static_assert(rover::state_heading_raw(-1.03) == -16, "");
static_assert(rover::state_battery_raw(3.2814) == 3281, "");
static_assert(rover::state_battery_raw(1e9) == 65535, "");
static_assert(rover::state_battery_raw(-1.0F) == 0, "");

// By hand: 3 / 0.001, and -1 * 16; just less than half of 1/16 is nearer to 0 than to 1.
static_assert(rover::state_battery_raw(3) == 3000, "");
static_assert(rover::state_heading_raw(-1L) == -16, "");
static_assert(rover::state_heading_raw(0.031249998F) == 0, "");
static_assert(rover::state_heading_raw(-0.03125) == -1, "");

static int turns, others;

static void on_drive(const rover::drive &drive) {
    turns += drive.left;
}

static void on_event(const rover::host_event &event) {
    if (event.kind == rover::event_kind::invalid && event.reason != rover::reason::no_reason) {
        others++;
    }
}

struct board {
    int left;
    void operator()(const rover::drive &drive, const rover::host_parts &parts) {
        left = parts.type == ROVER_DRIVE_ID ? drive.left : 0;
    }
};

static bool takes_whatever_holds_bytes() {
    rover::drive drive{};
    drive.left = 500;
    std::vector<uint8_t> vector(rover::frame_room<rover::drive>());
    std::array<uint8_t, 20> array{};
    uint8_t plain[20];
    rover::host_decoder decoder;
    turns = 0;
    decoder.feed(rover::frame(drive, vector), on_drive);
    decoder.feed(rover::frame(drive, array), on_drive);
    decoder.feed(rover::frame(drive, plain), on_drive);
    decoder.feed(rover::frame(drive, {plain + 2, 18}), on_drive);
#if __cplusplus >= 202002L
    const rover::framed made = rover::frame(drive, std::span(plain));
    const std::span<const uint8_t> bytes = made;
    decoder.feed(bytes, on_drive);
    const rover::state state{.mode = 1, .battery = 12, .heading = 3};
    return turns == 2500 && state.mode == rover::state_mode::driving;
#else
    return turns == 2000;
#endif
}

static bool the_first_handler_that_takes_an_event_gets_it() {
    rover::drive drive{};
    drive.left = 7;
    uint8_t buffer[rover::frame_room<rover::drive>()];
    const rover::framed made = rover::frame(drive, buffer);
    const uint8_t noise[] = {1, 2, 3, 0};
    rover::host_decoder decoder;
    board left = {0};
    turns = others = 0;
    decoder.feed(made, left, on_drive, on_event);
    decoder.feed(noise, left, on_event);
    for (uint8_t byte : made) {
        decoder.push(byte, on_event, on_drive);  // Events go in front of messages here.
    }
    decoder.push(1, on_event);
    decoder.flush(on_event);
    return left.left == 7 && turns == 0 && others == 2;
}

/* Found by its arguments if a call does not say whose `load` it means. */
void load(rover::drive &drive, const rover::host_event &event);
void load(rover::drive &, const rover::host_event &) {}

__attribute__((warn_unused_result)) static int answer(const rover::drive &drive) {
    turns += drive.left;
    return turns;
}

static bool a_copy_goes_on_where_the_first_one_is() {
    rover::drive drive{};
    drive.left = 3;
    uint8_t buffer[rover::frame_room<rover::drive>()];
    const rover::framed made = rover::frame(drive, buffer);
    rover::host_decoder decoder;
    turns = 0;
    decoder.feed({made.data(), 4}, answer);
    rover::host_decoder copy = decoder;
    decoder.feed({made.data() + 4, made.size() - 4}, answer);
    copy.feed({made.data() + 4, made.size() - 4}, &answer);
    return turns == 6;
}

static bool refuses_what_c_refuses() {
    rover::drive drive{};
    drive.left = 2001;
    uint8_t buffer[rover::frame_room<rover::drive>()];
    const rover::framed far = rover::frame(drive, buffer);
    const rover::encoded why = rover::encode(drive, buffer);
    drive.left = 2000;
    const rover::framed small = rover::frame(drive, {buffer, 3});
    const rover::encoded short_of = rover::encode(drive, {buffer, 3});
    rover::drive read{};
    const uint8_t payload[] = {0xD0, 0x07, 0x18, 0xFC};
    return !far && far.size() == 0 && !small && small.begin() == small.end() && !why &&
           why.why() == rover::result::error_range && why.size() == 0 && !short_of &&
           short_of.why() == rover::result::error_space &&
           rover::decode(read, payload) == rover::result::ok && read.left == 2000 &&
           read.right == -1000 &&
           rover::decode(read, {payload, 3}) == rover::result::error_size;
}

static bool names_are_those_of_the_schema() {
    const rover::state_mode none = rover::state_mode(9);
    return std::strcmp(rover::name(rover::state_mode::blocked), "blocked") == 0 &&
           std::strcmp(rover::name(rover::message::drive), "drive") == 0 &&
           std::strcmp(rover::name(none), "?") == 0;
}

int main() {
    const bool is_fine = takes_whatever_holds_bytes() && names_are_those_of_the_schema() &&
                         the_first_handler_that_takes_an_event_gets_it() &&
                         a_copy_goes_on_where_the_first_one_is() && refuses_what_c_refuses();
    return is_fine ? 0 : 1;
}
