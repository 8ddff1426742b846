"""Messages written field by field in the buffer of their frame, held against Python's frames."""

from __future__ import annotations

import ctypes
import re
import subprocess
from collections.abc import Iterator, Sequence
from functools import cache
from itertools import islice
from pathlib import Path
from random import Random
from tempfile import TemporaryDirectory
from typing import Any, NamedTuple

import pytest
from c_in_place_frames import FRAMES, TYPES
from c_library import FLAGS, OK, write_sources
from c_numbers_first import BITS, FILLED, NUMBERS_FIRST, OTHERS_FIRST, first_schema
from c_structs import Unfit, Values, count_name, fill, structure_of
from compiled import ROOT, module_at, protocol_of
from hypothesis import given, settings
from hypothesis import strategies as st
from test_c_codecs import spoilings
from tooling import require_tool

from protogen.fuzzing.samples import boundary_rounds, samples
from protogen.model.messages import Message
from protogen.model.types import Array, Counted, Field, Fill, Float, Integer, Struct, Type
from protogen.runtime.attributes import arguments
from protogen.runtime.errors import EncodeError
from protogen.targets.c.emit import texts, unit_of
from protogen.targets.c.frame.message_frames import MessageFrame
from protogen.targets.c.options import COptions

MESSAGES = (
    f"{TYPES.rstrip()}\n"
    + """messages:
  turn:
    id: 1
    from: board
    fields:
      status: {type: uint8, flags: {ready: 0}}
      distances: {type: uint16, count: 90, range: [1, 4000], special: {nothing: 0}}
  all:
    id: 0x7E
    from: board
    fields:
      on: {type: bool, default: true}
      small: {type: sint16, default: -32768}
      magic: {type: bytes, size: 3, const: {hex: 00 C0 DB}}
      level: {type: uint16, range: [5, 9], default: 7}
      real: {type: float32, range: [0, 1]}
      wide: {type: float64, default: 0.5}
      name: {type: ascii, size: 6, default: gain}
      key: {type: bytes, size: 3}
      at: point
      points: {type: point, count: 3}
      deep: {type: sint24, byte_order: big, count: 5, range: [-100, 8000000]}
      three: {type: uint8, count: 3, default: [1, 2, 3]}
      many: {type: uint64, count: 2}
      gains: {type: float64, count: 2}
  unset:
    id: 3
    from: board
    fields:
      kind: kind
      bounded: {type: float32, range: [0.5, 2]}
      first: step
      steps: {type: step, count: 2}
      kinds: {type: kind, count: 14}
      odd: {type: sint12, count: 2, range: [-5, -1]}
  plain: {id: 5, from: board, fields: {x: {type: bytes, size: 40}}}
  short: {id: 6, from: board, fields: {x: {type: uint16, count: 15}}}
"""
)
SCHEMAS = [
    ROOT / "schemas" / "rn1.yaml",
    *(
        ROOT / "tests" / "c_schemas" / f"{name}.yaml"
        for name in ("elements", "sampler", "sampler7", "tagged", "bounded", "by_position")
    ),
    *(
        ROOT / "tests" / "framings" / f"{name}.yaml"
        for name in ("hdlc_lenient", "digit_lengths", "sequences_marked", "virtual_parts", "forms")
    ),
]
"""Bytes that carry seven bits, floats, texts, and an array that is tagged; frames of many kinds."""

HEAD = """
#include "{name}.c"
#include <string.h>
static uint8_t before[2048];
#define TRY(call) \\
    if (turn++ != skipped) {{ \\
        memcpy(before, frame, capacity); \\
        if (!(call)) {{ \\
            refused = true; \\
            if (memcmp(before, frame, capacity) != 0) {{ return -2; }} \\
        }} \\
    }}
static int ended(size_t made, size_t *size) {{
    *size = made;
    return made == 0 ? 200 : 0;
}}
"""
BEGUN = """
int begun_{name}(uint8_t *frame, size_t capacity, size_t *size{parts}) {{
    return {begin}(frame, capacity) == NULL ? -1 : ended({end}({given}frame), size);
}}
"""
WRITE = """
int write_{name}({struct} *message, int skipped, uint8_t *frame, size_t capacity,
                 size_t *size{parts}) {{
    int turn = 0;
    bool refused = false;
    uint8_t *const payload = {begin}({first}frame, capacity);
    if (payload == NULL) {{
        return -1;
    }}
{calls}
    if (!refused && skipped < 0) {{
{reads}
    }}
    return refused ? 100 : ended({end}({numbers}{given}frame), size);
}}
"""
_NO_ROOM, _REFUSED, _NO_FRAME = -1, 100, 200


class Way(NamedTuple):
    """A message, its sender, and the functions that write it."""

    path: Path
    sender: str
    message: Message
    library: ctypes.CDLL
    suffix: str
    """What tells the frame from the message's others."""
    room: int
    parts: tuple[str, ...]
    first: tuple[str, ...]
    """The numbers that are given first."""

    def write(
        self, values: Values, parts: Values, capacity: int | None = None, skipped: int = -1
    ) -> tuple[int, bytes]:
        """Write all fields but one; raises Unfit where no struct has such values."""
        record = structure_of(self.message.fields)()
        fill(record, self.message.fields, values, {})
        return self._called("write", parts, capacity, ctypes.byref(record), skipped)

    def begun(self, parts: Values) -> tuple[int, bytes]:
        """End what was begun, with no field set."""
        return self._called("begun", parts, None)

    def _called(
        self, word: str, parts: Values, capacity: int | None, *first: Any
    ) -> tuple[int, bytes]:
        buffer, size = (ctypes.c_uint8 * self.room)(), ctypes.c_size_t(0)
        room = ctypes.c_size_t(self.room if capacity is None else capacity)
        given = (ctypes.c_uint64(parts[name]) for name in self.parts)
        function = getattr(self.library, f"{word}_{self.message.name}{self.suffix}")
        result = function(*first, buffer, room, ctypes.byref(size), *given)
        return result, bytes(buffer[: size.value])

    def frame(self, values: Values, parts: Values) -> bytes | None:
        """What Python makes of it; None where it refuses the values."""
        module = module_at(self.path)
        try:
            record = module.MESSAGES[self.message.name].from_dict(values)
            made: bytes = module.encode(record, self.sender, **arguments(parts))
        except EncodeError:
            return None
        return made

    def samples(self, dice: Random, random: int) -> list[tuple[Values, Values]]:
        """Values with each boundary, and random ones, with parts of their frames."""
        frame = protocol_of(self.path).sender(self.sender).frame
        found = samples(self.message, frame, dice)
        return list(islice(found, boundary_rounds(self.message, frame) + random))


@cache
def folder() -> TemporaryDirectory[str]:
    return TemporaryDirectory(prefix="protogen-place-")


VARIED = """
  scan:
    id: 0x10
    from: board
    fields:
      status: {type: uint8, default: 3}
      count: {type: uint8, range: [1, 40]}
      ranges: {type: uint16, count: count, range: [1, 4000], special: {nothing: 0xFFFF}}
      strengths: {type: uint8, count: count, range: [1, 200]}
      number: {type: uint16, byte_order: big, range: [0, 9]}
      steps: {type: step, count: number}
      level: {type: sint24, range: [-5, -1]}
  log:
    id: 0x11
    from: board
    fields: {level: {type: uint8, range: [1, 5]}, text: {type: ascii, size: {fill: true, max: 90}}}
  dump:
    id: 0x12
    from: board
    fields:
      size: {type: uint16, range: [0, 100]}
      data: {type: bytes, size: size}
      name: {type: ascii, size: 5, default: flash}
      again: {type: ascii, size: size}
  block: {id: 0x13, from: board, fields: {points: {type: point, count: {fill: true, max: 20}}}}
  rows:
    id: 0x14
    from: board
    fields: {n: {type: uint8, range: [2, 9]}, rows: {type: row, count: n}}
  few: {id: 0x16, from: board, fields: {n: {type: uint8, range: [0, 9]}, x: {type: ascii, size: n}}}
"""
LONG = """
  long: {id: 4, from: board, fields: {n: uint8, x: {type: uint8, count: n}}}
"""
WITHOUT = {"trimmed": "", "short_cobs": VARIED}
"""Frames that do not take them all."""


@cache
def schema(name: str) -> Path:
    """The messages above in frames of one kind."""
    path = Path(folder().name, f"{name}.yaml")
    if name.startswith("first_"):
        path.write_text(first_schema(name, name.removeprefix("first_")), encoding="utf-8")
        return path
    messages = MESSAGES.rstrip() + WITHOUT.get(name, VARIED.rstrip() + LONG)
    path.write_text(f"protocol: {name}{FRAMES[name]}{messages}", encoding="utf-8")
    return path


@cache
def ways(path: Path) -> list[Way]:
    """The messages of a schema that are written in place, compiled."""
    protocol, unit = protocol_of(path), unit_of(protocol_of(path), COptions())
    place = Path(folder().name, protocol.name)
    place.mkdir()
    name = write_sources(protocol, place)
    programs, found = [HEAD.format(name=name)], []
    for item in unit.framing.messages:
        if item.in_place is None:
            continue
        programs.append(written(item))
        parts = tuple(argument.part for argument in item.arguments)
        sender, suffix = item.decoder.name, item.called.suffix
        found.append((sender, item.message, suffix, item.room, parts, first_of(item)))
    (place / "shim.c").write_text("".join(programs), encoding="utf-8")
    command = [require_tool("cc"), *FLAGS, "-O1", "-fPIC", "-shared", "shim.c", "-o", "shim.so"]
    done = subprocess.run(command, cwd=place, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    library = ctypes.CDLL(str(place / "shim.so"))
    return [Way(path, sender, it, library, *others) for sender, it, *others in found]


def first_of(item: MessageFrame) -> tuple[str, ...]:
    """The numbers of a message that `begin` takes."""
    others = OTHERS_FIRST.get(item.view.struct, ())
    return NUMBERS_FIRST.get(item.message.name, others)


def written(item: MessageFrame) -> str:
    """The C that writes a message field by field out of a struct."""
    given = [argument.name for argument in item.arguments]
    fields = [field for field in item.message.fields if field.const is None]
    first, numbers = first_of(item), numbers_of(fields)
    settable = [it for it in fields if it.name not in (*numbers.values(), *first)]
    last = [it for name, it in numbers.items() if not first or it.startswith(f"{name}_")]
    prefix = item.view.struct[7:]
    forms = {
        "name": f"{item.message.name}{item.called.suffix}",
        "struct": item.view.struct,
        "begin": item.called.begin,
        "end": item.called.end,
        "given": "".join(f"({it.type}){it.name}, " for it in item.arguments),
        "parts": "".join(f", uint64_t {name}" for name in given),
        "first": "".join(f"message->{it}, " for it in first),
        "numbers": "".join(f"message->{it}, " for it in dict.fromkeys(last)),
        "calls": "\n".join(calls(prefix, settable, numbers, is_first=bool(first))),
        "reads": "\n".join(reads(prefix, settable, numbers, is_first=bool(first))),
    }
    return (WRITE if numbers else WRITE + BEGUN).format_map(forms)


def numbers_of(fields: Sequence[Field]) -> dict[str, str]:
    """For each field whose size varies, the member of the struct that says the number."""
    found = {}
    for field in fields:
        extent = field.type.extent
        if isinstance(extent, Counted):
            found[field.name] = extent.label
        elif isinstance(extent, Fill):
            found[field.name] = count_name(fields, field)
    return found


def in_struct(number: str) -> str:
    """The C of a number of elements, which may be worked out."""
    if number in BITS:
        return BITS[number]
    return re.sub(r"[a-z_][\w.]*", r"message->\g<0>", number).replace("//", "/")


def calls(
    prefix: str, fields: Sequence[Field], numbers: dict[str, str], *, is_first: bool
) -> Iterator[str]:
    """Statements that set each field, and elements that are none."""
    for field in fields:
        function, member = f"{prefix}_{field.name}_set", f"message->{field.name}"
        and_ = "&" if isinstance(field.element, Struct) else ""
        most = f"sizeof {member} / sizeof {member}[0]"
        if isinstance(field.type, Array):
            count = in_struct(numbers[field.name]) if field.name in numbers else most
            yield f"    for (size_t i = 0; i < (size_t)({count}); i++) {{"
            yield f"        TRY({function}_at(payload, i, {and_}{member}[i]))\n    }}"
            yield "    for (size_t shift = 0; shift < 64; shift += 7) {"
            past = f"{most} + (((size_t)1 << shift) - 1U)"
            yield f"        if ({function}_at(payload, {past}, {and_}{member}[0])) {{"
            yield "            return -4;\n        }\n    }"
            if is_first and not numbers.get(field.name, "").startswith(f"{field.name}_"):
                yield f"    if ({function}_at(payload, (size_t)({count}), {and_}{member}[0])) {{"
                yield "        return -6;\n    }"
        elif field.name in numbers:
            all_ = f"(size_t)({in_struct(numbers[field.name])})"
            yield "    {"
            yield f"        const size_t all = {all_}, half = all / 2;"
            yield f"        TRY({function}_at(payload, half, {member} + half, all - half))"
            yield f"        TRY({function}_at(payload, 0, {member}, half))"
            for index, size in (("0", f"{most} + 1"), (f"{most} + 1", "0"), ("1", most)):
                yield f"        if ({function}_at(payload, {index}, {member}, {size}) ||"
                yield f"            {function}_at(payload, {index}, {member}, SIZE_MAX)) {{"
                yield "            return -5;\n        }"
            yield "    }"
        else:
            yield f"    TRY({function}(payload, {and_}{member}))"


def reads(
    prefix: str, fields: Sequence[Field], numbers: dict[str, str], *, is_first: bool
) -> Iterator[str]:
    """Statements that read numbers and structs again, where they stay when the frame is ended."""
    for field in (it for it in fields if is_first or it.position is not None):
        member = f"message->{field.name}"
        if isinstance(field.type, Integer | Float | Struct):
            yield from _same(member, f"{prefix}_{field.name}_get(payload", field.type)
        elif isinstance(field.type, Array) and is_first and field.name in numbers:
            count = in_struct(numbers[field.name])
            yield f"    for (size_t i = 0; i < (size_t)({count}); i++) {{"
            call = f"{prefix}_{field.name}_at(payload, i"
            yield from _same(f"{member}[i]", call, field.type.element)
            yield "    }"


def _same(member: str, call: str, type_: Type) -> Iterator[str]:
    yield f"        {{\n            __typeof__({member}) found;"
    yield "            memset(&found, 0, sizeof found);"
    yield f"            {call}, &found);" if isinstance(type_, Struct) else f"found = {call});"
    yield f"            if (memcmp(&found, &{member}, sizeof found) != 0) {{"
    yield "                return -3;\n            }\n        }"


FIRST_FRAMES = [f"first_{frame}" for frame in FRAMES if frame != "trimmed"]
"""Frames of messages whose numbers are given first."""
EVERY_SCHEMA = pytest.mark.parametrize(
    "name", [*FRAMES, *FIRST_FRAMES, *(path.stem for path in SCHEMAS)]
)


STUFFED_PAST_LIMIT = ("first_cobs", "first_short_cobs", "first_slip")
"""Some of their longest frames have too many bytes once they are stuffed."""
BYTES_MAY_BE_ANY = ("elements", "tagged", "bounded")


def ways_of(name: str) -> list[Way]:
    path = (
        schema(name)
        if name in (*FRAMES, *FIRST_FRAMES)
        else next(it for it in SCHEMAS if it.stem == name)
    )
    return ways(path)


@EVERY_SCHEMA
@settings(max_examples=5)
@given(seed=st.integers(0, 2**32))
def test_frames_written_in_place_are_those_that_python_makes(name: str, seed: int) -> None:
    assert ways_of(name)
    for way in ways_of(name):
        for values, parts in way.samples(Random(seed), 3):
            expected = way.frame(values, parts)
            assert expected is not None or name in STUFFED_PAST_LIMIT
            made = (_NO_FRAME, b"") if expected is None else (OK, expected)
            assert way.write(values, parts) == made


@EVERY_SCHEMA
def test_values_that_python_refuses_are_refused_and_nothing_is_written(name: str) -> None:
    count = 0
    for way in ways_of(name):
        for values, parts in way.samples(Random(name), 2)[-4:]:
            for spoilt in spoilings(way.message.fields, values, frozenset(), {}):
                expected = way.frame(spoilt, parts)
                try:
                    made = way.write(spoilt, parts)
                except Unfit:
                    assert expected is None
                    continue
                refused = [(_REFUSED, b""), (_NO_FRAME, b"")][: 1 + (name in STUFFED_PAST_LIMIT)]
                assert made in (refused if expected is None else [(OK, expected)])
                count += expected is None
    assert count or name in BYTES_MAY_BE_ANY


@EVERY_SCHEMA
def test_a_buffer_that_is_too_short_is_left_alone(name: str) -> None:
    for way in ways_of(name):
        values, parts = way.samples(Random(name), 1)[-1]
        frame = way.frame(values, parts)
        assert frame is not None
        needed = len(frame) if way.first else way.room
        for capacity in (0, needed - 1):
            assert way.write(values, parts, capacity) == (_NO_ROOM, b"")


def test_numbers_that_are_given_first_need_no_more_room_than_they_say() -> None:
    ways = [way for way in ways_of("first_plain") if way.message.name not in FILLED]
    assert len(ways) == len(NUMBERS_FIRST) - len(FILLED)
    for way in ways:
        for values, parts in way.samples(Random("room"), 3):
            frame = way.frame(values, parts)
            assert frame is not None
            assert way.write(values, parts, len(frame)) == (OK, frame)
            assert way.write(values, parts, len(frame) - 1) == (_NO_ROOM, b"")


def test_what_was_begun_has_the_defaults_of_its_fields() -> None:
    point = "0000 07 fdff"
    payload = bytes.fromhex(
        f"""
        01 0080 00c0db 0700 00000000 000000000000e03f
        6761696e0000 000000 {point} {3 * point} {5 * "000000"}
        010203 {16 * "00"} {16 * "00"}
        """
    )
    content = bytes([0x7E, *len(payload).to_bytes(2, "little"), *payload])
    [way] = [way for way in ways_of("plain") if way.message.name == "all"]
    assert way.begun({}) == (OK, b"\x55" + content + bytes([sum(content) % 256]))


@pytest.mark.parametrize("name", FRAMES)
def test_what_has_no_default_that_is_allowed_has_to_be_set(name: str) -> None:
    [way] = [way for way in ways_of(name) if way.message.name == "unset"]
    values, parts = way.samples(Random(name), 1)[-1]
    assert way.begun(parts) == (_NO_FRAME, b"")
    calls = 21  # One for each field, and each element.
    for skipped in range(calls):
        assert way.write(values, parts, skipped=skipped) == (_NO_FRAME, b"")
    assert way.write(values, parts, skipped=calls) == (OK, way.frame(values, parts))


def test_there_is_nothing_for_messages_that_are_short_or_have_no_array() -> None:
    """Nor where the number of elements is worked out."""
    fixed, varied = ["turn", "all", "unset"], ["scan", "log", "dump", "block", "rows", "long"]
    assert [way.message.name for way in ways_of("slip")] == [*fixed, *varied]


TURN = 727
"""Bytes for a turn of a lidar, of which the frame has 722."""
SENDS = """
#include "rn1.h"
volatile uint8_t port;
static uint8_t frame[RN1_LIDAR_FRAME_ROOM];
int main(void) {
    uint8_t *const turn = rn1_lidar_begin(frame, sizeof frame);
    size_t size;
    (void)rn1_lidar_status_set(turn, port);
    for (size_t i = 0; i < 360; i++) {
        (void)rn1_lidar_distances_set_at(turn, i, (uint16_t)(port * 60U));
    }
    size = rn1_lidar_end(frame);
    for (size_t i = 0; i < size; i++) {
        port = frame[i];
    }
    return 0;
}
"""
RECEIVES = """
#include "rn1.h"
volatile uint8_t port;
static struct rn1_brain_decoder decoder;
int main(void) {
    for (;;) {
        const enum rn1_message message = rn1_brain_decoder_push(&decoder, port);
        if (message == RN1_MESSAGE_LIDAR) {
            struct rn1_brain_event event;
            rn1_brain_decoder_event(&decoder, message, &event);
            port = rn1_lidar_status_get(event.payload);
            for (size_t i = 0; i < 360; i++) {
                port = (uint8_t)(rn1_lidar_distances_at(event.payload, i) >> 6);
            }
        }
    }
}
"""


@pytest.mark.parametrize("program", [SENDS, RECEIVES], ids=["sends", "receives"])
def test_a_turn_of_a_lidar_takes_one_buffer(program: str, tmp_path: Path) -> None:
    options = COptions(events="messages", only=("lidar",))
    header, source = texts(protocol_of(ROOT / "schemas" / "rn1.yaml"), options)
    for name, text in {"rn1.h": header, "rn1.c": source, "main.c": program}.items():
        (tmp_path / name).write_text(text, encoding="utf-8")
    flags = ["-std=c99", "-mmcu=atmega328p", "-Os", "-DRN1_NO_HANDLERS"]
    small = ["-ffunction-sections", "-fdata-sections", "-Wl,--gc-sections"]
    command = [require_tool("avr-gcc"), *flags, *small, "main.c", "rn1.c", "-o", "main.elf"]
    for call in (command, [require_tool("avr-size"), "main.elf"]):
        done = subprocess.run(call, cwd=tmp_path, capture_output=True, text=True, check=False)
        assert (done.returncode, done.stderr) == (0, "")
    _, data, zeros, *_ = map(int, done.stdout.splitlines()[1].split()[:3])
    assert data + zeros - 1 <= TURN  # The port is none of it.
