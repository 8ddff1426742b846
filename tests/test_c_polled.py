"""Decoders of messages alone have one interface, whatever the framing is."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest
from compiled import protocol_of
from tooling import require_tool

from protogen.targets.c.emit import emit
from protogen.targets.c.options import COptions

MESSAGES = COptions(events="messages")
SCHEMA = """
protocol: weather
max_frame: 30
endpoints: {{station: Weather station}}
byte_order: big
decisions: {{anywhere: {{document: d, question: q, choice: c, because: b}}}}
{frame}
messages:
  wind: {{id: 1, from: station, fields: {{speed: uint16}}}}
  gust: {{id: 2, from: station, fields: {{speed: uint16}}}}
"""
LONG = "  note: {id: 3, from: station, fields: {a: {type: bytes, size: {fill: true, max: 20}}}}\n"
SYNC = """
frame:
  start: {literal: 0x55, unprotected: anywhere}
  length: {type: uint8, counts: payload, range: [0, 20]}
  id: {type: uint8, id: true}
  payload: {}
  check: {type: uint8, algorithm: sum-8, covers: length..payload}
"""
FRAMINGS = {
    "a sync byte that may be data": SYNC,
    "zeros between frames": """
frame:
  id: {type: uint8, id: true}
  payload: {}
  check: {type: uint8, algorithm: sum-8, covers: [id, payload]}
  end: {literal: 0}
transparency: {encoding: cobs}
""",
    "an escape": """
frame:
  start: {literal: 0x7E}
  id: {type: uint8, id: true}
  payload: {}
  check: {type: uint8, algorithm: sum-8, covers: [id, payload]}
transparency: {covers: id..check, escape: {byte: 0x7D, of: [0x7D, 0x7E], transform: {xor: 0x20}}}
""",
    "an end that may be data": """
frame:
  id: {type: uint8, id: true}
  payload: {}
  check: {type: uint8, algorithm: sum-8, covers: [id, payload]}
  end: {literal: 0x0A, unprotected: anywhere}
""",
    "a silence": """
frame:
  id: {type: uint8, id: true}
  payload: {}
  check: {type: uint8, algorithm: sum-8, covers: [id, payload]}
  end: {idle: 3.5 characters}
link: {baud: 9600}
""",
}
PROGRAM = """
#include "weather.h"

static struct weather_station_decoder decoder;
static uint8_t stream[200];
static size_t size;

void weather_on_wind(void *user, const struct weather_wind *message,
                     const struct weather_station_parts *parts) {
    (void)parts;
    *(unsigned *)user += message->speed;
}

static unsigned loaded(const struct weather_station_event *event) {
    struct weather_wind wind;
    weather_wind_load(&wind, event->payload);
    return event->message == WEATHER_MESSAGE_WIND ? wind.speed : 1000U;
}

static unsigned drained(enum weather_message message) {
    unsigned sum = 0;
    for (; message != WEATHER_NO_MESSAGE; message = weather_station_decoder_next(&decoder)) {
        struct weather_station_event event;
        weather_station_decoder_event(&decoder, message, &event);
        sum += loaded(&event);
    }
    return sum;
}

static unsigned pushed(size_t from, size_t to) {
    unsigned sum = 0;
    for (; from < to; from++) {
        sum += drained(weather_station_decoder_push(&decoder, stream[from]));
    }
    return sum + drained(weather_station_decoder_flush(&decoder));
}

static unsigned fed(size_t from, size_t to) {
    unsigned sum = 0;
    struct weather_station_event event;
    do {
        from += weather_station_decoder_feed(&decoder, &stream[from], to - from, &event);
        if (event.message != WEATHER_NO_MESSAGE) {
            sum += loaded(&event);
        }
    } while (event.message != WEATHER_NO_MESSAGE);
    return sum + drained(weather_station_decoder_idle(&decoder));
}

static unsigned dispatched(size_t from, size_t to) {
    unsigned sum = 0;
    weather_station_decoder_dispatch(&decoder, &stream[from], to - from, &sum);
    return sum + drained(weather_station_decoder_idle(&decoder));
}

int main(void) {
    static unsigned (*const ways[])(size_t, size_t) = {pushed, fed, dispatched};
    size_t ends[4] = {0};
    unsigned way, number;
    for (number = 0; number < 3; number++) {
        const struct weather_wind wind = {(uint16_t)(0x0A55U << number)};
        const size_t taken = weather_wind_frame(&wind, &stream[size], sizeof stream - size);
        if (taken == 0) {
            return 1;
        }
        size += taken;
        ends[number + 1] = size;
    }
    for (way = 0; way < 3; way++) {
        unsigned sum = 0;
        for (number = 0; number < 3; number++) {
            sum += ways[way](ends[number], ends[number + 1]);
        }
        if (sum != 7 * 0x0A55U) {
            return 2 + (int)way;
        }
    }
    return 0;
}
"""


def written(text: str, folder: Path) -> Path:
    path = folder / "weather.yaml"
    path.write_text(text, encoding="utf-8")
    return path


def run(program: str, schema: Path) -> int:
    """The exit code of a program for a schema."""
    folder = schema.parent
    for file in emit([protocol_of(schema)], MESSAGES):
        if file.path.name in ("weather.c", "weather.h"):
            (folder / file.path.name).write_bytes(file.bytes)
    (folder / "main.c").write_text(program, encoding="utf-8")
    command = [
        require_tool("cc"),
        "-std=c99",
        "-Wall",
        "-Wextra",
        "-Werror",
        "-fsanitize=undefined",
    ]
    subprocess.run([*command, "weather.c", "main.c", "-o", "main"], check=True, cwd=folder)
    return subprocess.run([folder / "main"], check=False).returncode


@pytest.mark.parametrize("framing", FRAMINGS)
def test_the_same_program_reads_every_framing(framing: str, tmp_path: Path) -> None:
    frame = FRAMINGS[framing]
    path = written(SCHEMA.format(frame=frame), tmp_path)
    assert run(PROGRAM.replace("0x0A55U", "0x0B55U" if "end" in framing else "0x0A55U"), path) == 0


# A false start, whose length says that what follows is payload: three frames, and two bytes more.
# 55, 18 bytes, [55, 2 bytes, wind, 100 + n, sum of the four bytes] three times, 00 00.
LATE = """
#include "weather.h"

static const uint8_t stream[] = {
    0x55, 0x12, 0x55, 0x02, 0x01, 0x00, 0x64, 0x67, 0x55, 0x02, 0x01, 0x00, 0x65, 0x68,
    0x55, 0x02, 0x01, 0x00, 0x66, 0x69, 0x00, 0x00};
static struct weather_station_decoder decoder;

static int speed(enum weather_message message) {
    struct weather_station_event event;
    struct weather_wind wind;
    if (message == WEATHER_NO_MESSAGE) {
        return 0;
    }
    weather_station_decoder_event(&decoder, message, &event);
    weather_wind_load(&wind, event.payload);
    return wind.speed;
}

#define REQUIRE(fact) do { if (!(fact)) { return __LINE__; } } while (0)

int main(void) {
    size_t index;
    /* All at the byte that proves the false start. */
    for (index = 0; index < 21; index++) {
        REQUIRE(speed(weather_station_decoder_push(&decoder, stream[index])) == 0);
    }
    REQUIRE(speed(weather_station_decoder_push(&decoder, stream[21])) == 100);
    REQUIRE(speed(weather_station_decoder_next(&decoder)) == 101);
    REQUIRE(speed(weather_station_decoder_next(&decoder)) == 102);
    REQUIRE(speed(weather_station_decoder_next(&decoder)) == 0);
    REQUIRE(speed(weather_station_decoder_next(&decoder)) == 0);
    /* Who does not ask gets them with the next bytes. */
    for (index = 0; index < 21; index++) {
        REQUIRE(speed(weather_station_decoder_push(&decoder, stream[index])) == 0);
    }
    REQUIRE(speed(weather_station_decoder_push(&decoder, stream[21])) == 100);
    REQUIRE(speed(weather_station_decoder_push(&decoder, 0)) == 101);
    REQUIRE(speed(weather_station_decoder_push(&decoder, 0)) == 102);
    REQUIRE(speed(weather_station_decoder_push(&decoder, 0)) == 0);
    /* A silence proves it, too, and `next` goes on behind it. */
    for (index = 0; index < 20; index++) {
        REQUIRE(speed(weather_station_decoder_push(&decoder, stream[index])) == 0);
    }
    REQUIRE(speed(weather_station_decoder_flush(&decoder)) == 100);
    REQUIRE(speed(weather_station_decoder_next(&decoder)) == 101);
    REQUIRE(speed(weather_station_decoder_next(&decoder)) == 102);
    REQUIRE(speed(weather_station_decoder_next(&decoder)) == 0);
    /* Who does not ask has only the first, and the next frame all the same. */
    for (index = 0; index < 20; index++) {
        REQUIRE(speed(weather_station_decoder_push(&decoder, stream[index])) == 0);
    }
    REQUIRE(speed(weather_station_decoder_flush(&decoder)) == 100);
    for (index = 2; index < 7; index++) {
        REQUIRE(speed(weather_station_decoder_push(&decoder, stream[index])) == 0);
    }
    REQUIRE(speed(weather_station_decoder_push(&decoder, stream[7])) == 100);
    return 0;
}
"""


def test_messages_that_a_false_start_held_back_come_one_by_one(tmp_path: Path) -> None:
    assert run(LATE, written(SCHEMA.format(frame=SYNC) + LONG, tmp_path)) == 0
