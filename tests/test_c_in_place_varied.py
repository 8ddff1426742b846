"""Arrays whose number of elements varies, written in the buffer of their frame: by hand, with
sanitizers, on an ATmega328P, and in C++."""

from __future__ import annotations

import subprocess
from collections.abc import Sequence
from pathlib import Path

import pytest
from c_in_place_frames import FRAMES
from compiled import protocol_of
from cpp_shim import WARNINGS
from test_c_in_place import MESSAGES, VARIED
from tooling import require_compiler, require_tool

from protogen.targets.c.emit import emit
from protogen.targets.c.options import COptions

SANITIZED = ("-fsanitize=address,undefined", "-fno-sanitize-recover=all")
STRICT = ("-std=c99", "-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Werror")
BOARD = COptions(events="messages", hpp=True)


def made(schema: str, folder: Path, options: COptions = BOARD) -> Path:
    """The folder, with the C of a schema of this text, whose protocol is `place`."""
    path = folder / "place.yaml"
    path.write_text(schema, encoding="utf-8")
    for file in emit([protocol_of(path)], options):
        if file.path.suffix in (".c", ".h", ".hpp"):
            (folder / file.path.name).write_bytes(file.bytes)
    return folder


DOUBLED = """
  doubled:
    id: 0x20
    from: board
    fields:
      n: {type: uint8, range: [1, 20]}
      x: {type: uint16, count: n * 2}
      tail: {type: sint16, default: -7}
"""


def schema_in(frame: str) -> str:
    return f"protocol: place{FRAMES[frame]}{MESSAGES.rstrip()}{VARIED.rstrip()}{DOUBLED}"


def ran(folder: Path, text: str, *flags: str) -> None:
    """Compile a program with the source of C, and run it: nothing may fail."""
    (folder / "main.c").write_text(text, encoding="utf-8")
    compiler = require_compiler("cc", *SANITIZED)
    run([compiler, *STRICT, *SANITIZED, *flags, "place.c", "main.c", "-o", "main"], folder)
    run([folder / "main"], folder)


def run(command: Sequence[str | Path], folder: Path) -> str:
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


# --- by hand --------------------------------------------------------------------------------------

HEAD = """
#include "place.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#define EXPECT(condition) \\
    do { \\
        if (!(condition)) { printf("line %d: %s\\n", __LINE__, #condition); return 1; } \\
    } while (0)
"""
SCAN = """
static uint8_t frame[400];
int main(void) {
    static const uint8_t expected[] = {
        0x55, 0x10, 19, 0, /* start, id, length */
        3, 2, /* status, which was not set; count */
        0xE8, 0x03, 0xFF, 0xFF, /* ranges: 1000, nothing */
        9, 200, /* strengths */
        0, 2, /* number, with its upper byte first */
        1, 0, 2, 2, 0x01, 0x2C, /* steps */
        0xFE, 0xFF, 0xFF, /* level: -2 */
    };
    const struct place_step steps[] = {{1, 2}, {2, 300}};
    uint8_t *const scan = place_scan_begin(frame, sizeof frame);
    size_t size = 0;
    unsigned int sum = 0;
    EXPECT(scan != NULL);
    EXPECT(place_scan_level_set(scan, -2));
    EXPECT(place_scan_ranges_set_at(scan, 0, 1000) && place_scan_ranges_set_at(scan, 1, 0xFFFF));
    EXPECT(place_scan_strengths_set_at(scan, 1, 200));
    EXPECT(place_scan_ranges_set_at(scan, 39, 1)); /* It has room, but is not sent. */
    EXPECT(!place_scan_ranges_set_at(scan, 40, 1) && !place_scan_ranges_set_at(scan, 2, 4001));
    EXPECT(place_scan_steps_set_at(scan, 0, &steps[0]));
    EXPECT(place_scan_steps_set_at(scan, 1, &steps[1]));

    EXPECT(place_scan_end(2, 2, frame) == 0); /* strengths[0] is 0. */
    EXPECT(place_scan_strengths_set_at(scan, 0, 9));
    EXPECT(place_scan_end(3, 2, frame) == 0); /* strengths[2] is. */
    EXPECT(place_scan_end(0, 2, frame) == 0);
    EXPECT(place_scan_end(41, 2, frame) == 0);
    EXPECT(place_scan_end(2, 10, frame) == 0);
    EXPECT(size == 0);
    size = place_scan_end(2, 2, frame);
    EXPECT(size == sizeof expected + 1U && memcmp(frame, expected, sizeof expected) == 0);
    for (size_t i = 1; i < sizeof expected; i++) {
        sum += expected[i];
    }
    EXPECT(frame[size - 1U] == (uint8_t)sum);
    return 0;
}
"""
LIMITED = """
protocol: place
byte_order: big
endpoints: {board: Board}
frame:
  start: {literal: 0x55, unprotected: start}
  length: {type: uint8, counts: payload, range: [6, 40]}
  id: {type: uint8, id: true}
  payload: {}
decisions:
  start: {question: One inside?, document: No., choice: It is looked for., because: Nothing else.}
messages:
  registers:
    id: 7
    from: board
    fields: {first: uint16, count: uint8, values: {type: uint16, count: count}}
  log: {id: 8, from: board, fields: {text: {type: ascii, size: fill, default: none}}}
  two:
    id: 9
    from: board
    fields:
      n: uint8
      m: uint8
      x: {type: uint8, count: n}
      y: {type: uint8, count: m}
"""
LIMITS = """
static uint8_t frame[400];
int main(void) {
    size_t size = 0;
    uint8_t *payload = place_registers_begin(frame, PLACE_REGISTERS_FRAME_ROOM);
    EXPECT(PLACE_REGISTERS_FRAME_ROOM <= 43 && payload != NULL);
    EXPECT(place_registers_begin(frame, PLACE_REGISTERS_FRAME_ROOM - 1U) == NULL);
    EXPECT(place_registers_values_set_at(payload, 17, 0x1234));
    EXPECT(!place_registers_values_set_at(payload, 18, 0x1234)); /* 3 + 2 * 18 = 39 bytes of 40. */
    EXPECT(place_registers_end(19, frame) == 0);
    EXPECT(place_registers_end(1, frame) == 0); /* 5 bytes: a frame has 6. */
    size = place_registers_end(18, frame);
    EXPECT(size == 3U + 3U + 36U);
    EXPECT(frame[1] == 39U && frame[5] == 18U && frame[40] == 0x12U && frame[41] == 0x34U);

    payload = place_log_begin(frame, sizeof frame);
    EXPECT(!place_log_text_set_at(payload, 0, "\\x80", 1));
    EXPECT(!place_log_text_set_at(payload, 40, "e", 1));
    EXPECT(!place_log_text_set_at(payload, 41, "", 0));
    EXPECT(!place_log_text_set_at(payload, 39, "ab", SIZE_MAX));
    EXPECT(place_log_text_set_at(payload, 4, "!!", 2) && place_log_text_set_at(payload, 40, "", 0));
    EXPECT(place_log_end(5, frame) == 0);
    EXPECT(place_log_end(41, frame) == 0);
    size = place_log_end(6, frame);
    EXPECT(size == 9U && memcmp(frame, "\\x55\\x06\\x08none!!", 9) == 0);

    EXPECT(place_two_begin(20, 19, frame, sizeof frame) == NULL); /* 2 + 20 + 19 bytes of 40. */
    EXPECT(place_two_begin(255, 255, frame, sizeof frame) == NULL);
    EXPECT(place_two_begin(1, 2, frame, sizeof frame) == NULL); /* 5 bytes: a frame has 6. */
    EXPECT(place_two_begin(20, 18, frame, PLACE_TWO_FRAME_ROOM) != NULL);
    EXPECT(place_two_begin(3, 2, frame, 9) == NULL);
    payload = place_two_begin(3, 2, frame, 10);
    EXPECT(payload != NULL && place_two_m_get(payload) == 2U);
    EXPECT(place_two_y_set_at(payload, 1, 0xEE) && !place_two_y_set_at(payload, 2, 0xEE));
    EXPECT(place_two_x_set_at(payload, 2, 0xCC) && !place_two_x_set_at(payload, 3, 0xCC));
    EXPECT(place_two_y_at(payload, 1) == 0xEEU && place_two_y_at(payload, 0) == 0U);
    EXPECT(place_two_end(frame) == 10U);
    EXPECT(memcmp(frame, "\\x55\\x07\\x09\\3\\2\\0\\0\\xCC\\0\\xEE", 10) == 0);
    return 0;
}
"""


def test_a_frame_has_as_many_elements_as_are_given_when_it_is_ended(tmp_path: Path) -> None:
    ran(made(schema_in("plain"), tmp_path), HEAD + SCAN)


def test_no_more_elements_are_written_or_sent_than_a_frame_can_carry(tmp_path: Path) -> None:
    ran(made(LIMITED, tmp_path), HEAD + LIMITS)


# --- with sanitizers ------------------------------------------------------------------------------

ANYTHING = """
static uint32_t state = 1;
static uint32_t any(uint32_t below) {
    state = state * 1664525U + 1013904223U;
    return (state >> 8) % below;
}
static size_t anywhere(void) {
    return any(4) != 0 ? any(48) : any(8) != 0 ? SIZE_MAX - any(300) : (size_t)1 << any(32);
}
static int sent;

/* Takes a frame by the decoder, and makes it anew out of the struct. */
#define CHECK(name, id) \\
    static int check_##name(const uint8_t *made, size_t size) { \\
        struct place_board_decoder decoder = {0}; \\
        enum place_message found = PLACE_NO_MESSAGE; \\
        struct place_board_event event; \\
        struct place_##name message; \\
        static uint8_t again[1000]; \\
        size_t other; \\
        for (size_t i = 0; i < size; i++) { \\
            const enum place_message one = place_board_decoder_push(&decoder, made[i]); \\
            if (one != PLACE_NO_MESSAGE) { \\
                found = one; \\
                place_board_decoder_event(&decoder, one, &event); \\
            } \\
        } \\
        EXPECT(found == id); \\
        memset(&message, 0, sizeof message); \\
        place_##name##_load(&message, event.payload, event.payload_size); \\
        other = place_##name##_frame(&message, PARTS again, sizeof again); \\
        EXPECT(other == size && memcmp(again, made, size) == 0); \\
        sent++; \\
        return 0; \\
    }
CHECK(scan, PLACE_MESSAGE_SCAN)
CHECK(log, PLACE_MESSAGE_LOG)
CHECK(dump, PLACE_MESSAGE_DUMP)
CHECK(block, PLACE_MESSAGE_BLOCK)
CHECK(rows, PLACE_MESSAGE_ROWS)

static const char letters[200] = "Any text, which is longer than all that can be sent at once";

static int write_scan(uint8_t *buffer, size_t *size) {
    uint8_t *const at = place_scan_begin(buffer, PLACE_SCAN_FRAME_ROOM);
    const int given = (int)any(200);
    for (int i = 0; i < given; i++) {
        const struct place_step step = {(uint8_t)any(4), (uint16_t)any(400)};
        (void)place_scan_ranges_set_at(at, i < 40 ? (size_t)i : anywhere(), (uint16_t)any(5000));
        (void)place_scan_strengths_set_at(at, i < 40 ? (size_t)i : anywhere(), (uint8_t)any(210));
        (void)place_scan_steps_set_at(at, anywhere(), &step);
        (void)place_scan_level_set(at, -(int32_t)any(7));
    }
    *size = place_scan_end((uint8_t)any(46), (uint16_t)any(4), PARTS buffer);
    EXPECT(*size == 0 || check_scan(buffer, *size) == 0);
    return 0;
}
static int write_log(uint8_t *buffer, size_t *size) {
    uint8_t *const at = place_log_begin(buffer, PLACE_LOG_FRAME_ROOM);
    (void)place_log_level_set(at, (uint8_t)any(6));
    for (int i = 0; i < 9; i++) {
        (void)place_log_text_set_at(at, anywhere(), letters, anywhere());
    }
    *size = place_log_end((uint8_t)any(100), PARTS buffer);
    EXPECT(*size == 0 || check_log(buffer, *size) == 0);
    return 0;
}
static int write_dump(uint8_t *buffer, size_t *size) {
    uint8_t *const at = place_dump_begin(buffer, PLACE_DUMP_FRAME_ROOM);
    for (int i = 0; i < 9; i++) {
        (void)place_dump_data_set_at(at, anywhere(), (const uint8_t *)letters, anywhere());
        (void)place_dump_again_set_at(at, anywhere(), letters, anywhere());
    }
    *size = place_dump_end((uint16_t)any(110), PARTS buffer);
    EXPECT(*size == 0 || check_dump(buffer, *size) == 0);
    return 0;
}
static int write_block(uint8_t *buffer, size_t *size) {
    uint8_t *const at = place_block_begin(buffer, PLACE_BLOCK_FRAME_ROOM);
    for (int i = 0; i < 20; i++) {
        const struct place_point point = {(int16_t)any(30000), (int16_t)any(30000)};
        (void)place_block_points_set_at(at, anywhere(), &point);
    }
    *size = place_block_end((uint8_t)any(23), PARTS buffer);
    EXPECT(*size == 0 || check_block(buffer, *size) == 0);
    return 0;
}
static int write_rows(uint8_t *buffer, size_t *size) {
    uint8_t *const at = place_rows_begin(buffer, PLACE_ROWS_FRAME_ROOM);
    for (int i = 0; i < 20; i++) {
        const struct place_row row = {{(int16_t)any(110), -3, 5}, {(int16_t)any(30000), 1}};
        (void)place_rows_rows_set_at(at, anywhere(), &row);
    }
    *size = place_rows_end((uint8_t)any(12), PARTS buffer);
    EXPECT(*size == 0 || check_rows(buffer, *size) == 0);
    return 0;
}

#define TRY(name, room) \\
    do { \\
        uint8_t *const buffer = malloc(room); /* To the byte, as a write behind it is found. */ \\
        size_t size = 0; \\
        EXPECT(place_##name##_begin(buffer, room - 1U) == NULL); \\
        EXPECT(write_##name(buffer, &size) == 0 && size <= room); \\
        free(buffer); \\
    } while (0)

int main(void) {
    for (int turn = 0; turn < 2000; turn++) {
        TRY(scan, PLACE_SCAN_FRAME_ROOM);
        TRY(log, PLACE_LOG_FRAME_ROOM);
        TRY(dump, PLACE_DUMP_FRAME_ROOM);
        TRY(block, PLACE_BLOCK_FRAME_ROOM);
        TRY(rows, PLACE_ROWS_FRAME_ROOM);
    }
    EXPECT(sent > 4000);
    return 0;
}
"""


@pytest.mark.parametrize("frame", ["cobs", "short_cobs", "slip", "base16", "plain"])
def test_no_index_no_number_and_no_value_writes_beside_the_frame(
    frame: str, tmp_path: Path
) -> None:
    parts = "7," if frame == "cobs" else ""
    ran(made(schema_in(frame), tmp_path), f"{HEAD}#define PARTS {parts}\n{ANYTHING}", "-O1")


# --- one buffer -----------------------------------------------------------------------------------

LIDAR = """
protocol: place
byte_order: little
endpoints: {lidar: Lidar, host: Host}
frame:
  id: {type: uint8, id: true}
  payload: {}
  crc: {type: uint16, algorithm: CRC-16/KERMIT, covers: id..payload}
  end: {literal: 0x00}
transparency: {covers: id..crc, encoding: cobs}
messages:
  scan:
    id: 1
    from: [lidar, host]
    fields:
      status: uint8
      count: {type: uint16, range: [0, 360]}
      ranges: {type: uint16, count: count}
"""
ANSWERS = """
#include "place.h"
volatile uint8_t port;
/* The line is half duplex: what is written and what comes in have one buffer. */
static union {
    struct place_host_decoder decoder;
    uint8_t frame[PLACE_SCAN_FRAME_ROOM];
} line;

int main(void) {
    for (;;) {
        const enum place_message message = place_host_decoder_push(&line.decoder, port);
        if (message == PLACE_MESSAGE_SCAN) {
            struct place_host_event event;
            place_host_decoder_event(&line.decoder, message, &event);
            const uint16_t least = place_scan_ranges_at(event.payload, 0);
            const uint16_t count = place_scan_count_get(event.payload);
            uint8_t *const scan = place_scan_begin(line.frame, sizeof line.frame);
            for (size_t i = 0; i < count; i++) {
                (void)place_scan_ranges_set_at(scan, i, (uint16_t)(least + port));
            }
            const size_t size = place_scan_end(count, line.frame);
            for (size_t i = 0; i < size; i++) {
                port = line.frame[i];
            }
            place_host_decoder_init(&line.decoder);
        }
    }
}
"""
SCAN_BYTES = 3 + 2 * 360
"""A struct of the scan would take so many bytes more."""
AROUND = 20
"""Of a frame, and of a decoder, beside the payload."""


def test_a_scan_comes_in_and_goes_out_with_one_buffer(tmp_path: Path) -> None:
    made(LIDAR, tmp_path, COptions(events="messages"))
    (tmp_path / "main.c").write_text(ANSWERS, encoding="utf-8")
    flags = ["-std=c99", "-mmcu=atmega328p", "-Os", "-DPLACE_NO_HANDLERS", *STRICT[1:]]
    small = ["-ffunction-sections", "-fdata-sections", "-Wl,--gc-sections"]
    run([require_tool("avr-gcc"), *flags, *small, "main.c", "place.c", "-o", "main.elf"], tmp_path)
    _, data, zeros, *_ = (
        run([require_tool("avr-size"), "main.elf"], tmp_path).splitlines()[1].split()
    )
    assert SCAN_BYTES < int(data) + int(zeros) < SCAN_BYTES + AROUND


# --- C++ ------------------------------------------------------------------------------------------

STANDARDS = ("-std=c++11", "-std=c++14", "-std=c++17", "-std=c++20", "-std=c++2b")
WRITES = """
#include "place.hpp"
#include <cstdio>
#include <cstring>
#include <type_traits>
#define EXPECT(condition) \\
    do { \\
        if (!(condition)) { std::printf("line %d: %s\\n", __LINE__, #condition); return 1; } \\
    } while (0)

static uint8_t frame[place::frame_room<place::all>()], other[600], scans[600];

int main() {
    place::all all{};
    all.on = true;
    all.small = -32768;
    all.wide = 0.5;
    all.three[0] = 1;
    all.three[1] = 2;
    all.three[2] = 3;
    all.name[0] = 'g';
    all.at.y = all.points[0].y = all.points[1].y = all.points[2].y = -3;
    all.key[1] = 5;
    all.points[2].x = -9;
    all.gains[0] = 0.25;
    place::all_writer writer(frame);
    EXPECT(writer);
    EXPECT(writer.set_key(all.key) && writer.set_name(all.name) && writer.set_at(all.at));
    EXPECT(writer.set_points(2, all.points[2]) && writer.set_gains(0, all.gains[0]));
    EXPECT(!writer.set_points(3, all.points[2]) && !writer.set_level(4) && writer.set_level(9));
    all.level = 9;
    static_assert(!std::is_copy_constructible<place::all_writer>::value &&
                  !std::is_copy_assignable<place::all_writer>::value &&
                  !std::is_move_constructible<place::all_writer>::value, "one writes a frame");
    EXPECT(writer.get_level() == 9 && writer.get_on() && writer.get_at().y == -3);
    EXPECT(writer.get_points(2).x == -9 && writer.get_points(3).x == 0);
    EXPECT(writer.get_gains(0) >= 0.25 && writer.get_three(2) == 3 && writer.get_three(3) == 0);
    const place::framed made = writer.end();
    const place::framed expected = place::frame(all, other);
    EXPECT(made && expected && made.size() == expected.size());
    EXPECT(std::memcmp(frame, other, made.size()) == 0);
    EXPECT(!writer && !writer.set_level(7) && !writer.end()); /* It is gone. */
    EXPECT(writer.get_level() == 0 && writer.get_points(2).x == 0);

    place::scan scan{};
    place::scan_writer one(scans);
    scan.count = 3;
    scan.level = -1;
    EXPECT(one.set_level(-1) && one.set_status(0));
    for (uint8_t i = 0; i < 3; i++) {
        scan.ranges[i] = static_cast<uint16_t>(i + 1);
        scan.strengths[i] = 7;
        EXPECT(one.set_ranges(i, scan.ranges[i]) && one.set_strengths(i, 7));
    }
    const place::framed sent = one.end(3, 0);
    const place::framed like = place::frame(scan, other);
    EXPECT(sent && sent.size() == like.size() && std::memcmp(scans, other, sent.size()) == 0);

    place::scan_writer unset(scans);
    EXPECT(unset.set_ranges(0, 1) && unset.set_strengths(0, 1));
    EXPECT(!unset.end(1, 0));

    static const uint8_t data[] = {1, 2, 3};
    place::dump_writer dump(scans);
    EXPECT(dump);
    EXPECT(dump.set_data(97, data) && !dump.set_data(98, data));
    EXPECT(dump.set_again(0, "abc", 3) && dump.end(100));

    place::doubled_writer doubled(2, scans);
    EXPECT(doubled && doubled.get_n() == 2 && doubled.get_tail() == -7);
    EXPECT(doubled.set_x(3, 1000) && !doubled.set_x(4, 1000) && doubled.end());
    place::doubled_writer none(9, {scans, 20}), refused(200, scans);
    EXPECT(!none && !none.set_x(0, 5) && !refused && !refused.end() && refused.get_n() == 0);

    place::log_writer log({scans, 5});
    EXPECT(!log && !log.set_level(1) && !log.set_text(0, "a", 1));
    EXPECT(!log.end(1));
    return 0;
}
"""


@pytest.mark.parametrize("compiler", ["g++", "clang++"])
def test_cpp_writes_the_same_frames_in_each_standard(compiler: str, tmp_path: Path) -> None:
    made(schema_in("slip"), tmp_path)
    (tmp_path / "main.cc").write_text(WRITES, encoding="utf-8")
    run([require_tool("cc"), "-std=c99", "-O1", *SANITIZED, "-c", "place.c"], tmp_path)
    for standard in STANDARDS:
        command = [require_tool(compiler), standard, *WARNINGS]
        if standard in (STANDARDS[0], STANDARDS[-1]) and compiler == "g++":
            link = [*SANITIZED, "main.cc", "place.o", "-o", "main"]
            run([*command, *link], tmp_path)
            run([tmp_path / "main"], tmp_path)
        else:
            run([*command, "-fsyntax-only", "main.cc"], tmp_path)


SENDS = {
    "c": """
#include "place.h"
volatile uint8_t port;
static uint8_t frame[PLACE_SCAN_FRAME_ROOM];
int main(void) {
    uint8_t *const scan = place_scan_begin(frame, sizeof frame);
    size_t size;
    if (scan == NULL) {
        return 1;
    }
    (void)place_scan_status_set(scan, port);
    for (size_t i = 0; i < 360; i++) {
        (void)place_scan_ranges_set_at(scan, i, (uint16_t)(port * 60U));
    }
    size = place_scan_end(port, frame);
    for (size_t i = 0; i < size; i++) {
        port = frame[i];
    }
    return 0;
}
""",
    "cc": """
#include "place.hpp"
volatile uint8_t port;
static uint8_t frame[place::frame_room<place::scan>()];
int main() {
    place::scan_writer scan(frame);
    if (!scan) {
        return 1;
    }
    (void)scan.set_status(port);
    for (size_t i = 0; i < 360; i++) {
        (void)scan.set_ranges(i, static_cast<uint16_t>(port * 60U));
    }
    for (uint8_t byte : scan.end(port)) {
        port = byte;
    }
    return 0;
}
""",
}


def test_it_takes_hardly_more_flash_in_cpp(tmp_path: Path) -> None:
    made(LIDAR, tmp_path)
    c, cpp = require_tool("avr-gcc"), require_tool("avr-g++")
    board = ["-mmcu=atmega328p", "-Os", "-ffunction-sections", "-fdata-sections"]
    run([c, "-std=c99", *board, "-c", "place.c", "-o", "codec.o"], tmp_path)
    sizes = []
    for suffix, command in (("c", [c, "-std=c99"]), ("cc", [cpp, "-std=c++11", "-fno-exceptions"])):
        (tmp_path / f"main.{suffix}").write_text(SENDS[suffix], encoding="utf-8")
        run([*command, *board, "-c", f"main.{suffix}", "-o", "main.o"], tmp_path)
        run([c, *board, "main.o", "codec.o", "-Wl,--gc-sections", "-o", "main.elf"], tmp_path)
        lines = run([require_tool("avr-size"), "main.elf"], tmp_path).splitlines()
        sizes.append(sum(map(int, lines[1].split()[:2])))
    assert sizes[1] <= 1.02 * sizes[0], sizes
