"""Messages written field by field in the buffer of their frame, held against Python's frames."""

from __future__ import annotations

import ctypes
import subprocess
from collections.abc import Iterator, Sequence
from functools import cache
from itertools import islice
from pathlib import Path
from random import Random
from tempfile import TemporaryDirectory
from typing import Any, NamedTuple

import pytest
from c_library import FLAGS, OK, write_sources
from c_structs import Unfit, Values, fill, structure_of
from compiled import ROOT, module_at, protocol_of
from hypothesis import given, settings
from hypothesis import strategies as st
from test_c_codecs import spoilings
from tooling import require_tool

from protogen.fuzzing.samples import boundary_rounds, samples
from protogen.model.messages import Message
from protogen.model.types import Array, Field, Float, Integer, Struct
from protogen.runtime.attributes import arguments
from protogen.runtime.errors import EncodeError
from protogen.targets.c.emit import texts, unit_of
from protogen.targets.c.options import COptions

MESSAGES = """
byte_order: little
endpoints: {board: Board}
types:
  kind: {type: uint8, values: {one: 1, two: 2}, closed: true}
  point: {fields: {x: sint16, tag: {type: uint8, const: 7}, y: {type: sint16, default: -3}}}
  step: {fields: {kind: kind, level: {type: uint16, byte_order: big, range: [2, 300]}}}
messages:
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
FRAMES = {
    "cobs": """
frame:
  id: {type: uint8, id: true}
  number: {type: uint8, counter: true}
  payload: {}
  crc: {type: uint16, algorithm: CRC-16/MODBUS, covers: id..payload}
  end: {literal: 0x00}
transparency: {covers: id..crc, encoding: cobs}
""",
    "slip": """
frame:
  id: {type: uint8, id: true}
  payload: {}
  end: {literal: 0xC0}
transparency: slip
""",
    "base16": """
frame:
  begin: {literal: {text: b}}
  id: {type: uint8, id: true}
  payload: {}
  end: {literal: {text: e}}
transparency: {covers: id..payload, encoding: base16-upper}
""",
    "trimmed": """
frame:
  start: {literal: 0x55, unprotected: start}
  length: {type: uint8, counts: payload}
  id: {type: uint8, id: true}
  payload: {trailing_zeros: trimmed}
  sum: {type: uint8, algorithm: sum-8, covers: length..payload}
decisions:
  start: {question: One inside?, document: No., choice: The sum tells., because: Nothing else.}
""",
    "plain": """
frame:
  start: {literal: 0x55, unprotected: start}
  id: {type: uint8, id: true}
  length: {type: uint16, counts: payload}
  payload: {}
  sum: {type: uint8, algorithm: sum-8, covers: id..payload}
decisions:
  start: {question: One inside?, document: No., choice: The sum tells., because: Nothing else.}
""",
}
SCHEMAS = [
    ROOT / "schemas" / "rn1.yaml",
    *(ROOT / "tests" / "c_schemas" / f"{name}.yaml" for name in ("elements", "sampler", "tagged")),
]
"""Bytes that carry seven bits, floats, texts, and an array that is tagged."""

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
WRITE = """
int write_{name}({struct} *message, int skipped, uint8_t *frame, size_t capacity,
                 size_t *size{parts}) {{
    int turn = 0;
    bool refused = false;
    uint8_t *const payload = {begin}(frame, capacity);
    if (payload == NULL) {{
        return -1;
    }}
{calls}
    if (!refused && skipped < 0) {{
{reads}
    }}
    return refused ? 100 : ended({end}({given}frame), size);
}}
int begun_{name}(uint8_t *frame, size_t capacity, size_t *size{parts}) {{
    return {begin}(frame, capacity) == NULL ? -1 : ended({end}({given}frame), size);
}}
"""
_NO_ROOM, _REFUSED, _NO_FRAME = -1, 100, 200


class Way(NamedTuple):
    """A message, its sender, and the functions that write it."""

    path: Path
    sender: str
    message: Message
    library: ctypes.CDLL
    room: int
    parts: tuple[str, ...]

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
        function = getattr(self.library, f"{word}_{self.message.name}")
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
  varied: {id: 4, from: board, fields: {n: uint8, x: {type: uint8, count: n}}}
"""


@cache
def schema(name: str) -> Path:
    """The messages above in frames of one kind."""
    path = Path(folder().name, f"{name}.yaml")
    messages = MESSAGES if name == "trimmed" else MESSAGES.rstrip() + VARIED
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
        if item.view.in_place is None:
            continue
        given = [argument.name for argument in item.arguments]
        fields = [field for field in item.message.fields if field.const is None]
        programs.append(
            WRITE.format(
                name=item.message.name,
                struct=item.view.struct,
                begin=item.called.begin,
                end=item.called.end,
                given="".join(f"({it.type}){it.name}, " for it in item.arguments),
                parts="".join(f", uint64_t {name}" for name in given),
                calls="\n".join(calls(item.view.struct[7:], fields)),
                reads="\n".join(reads(item.view.struct[7:], fields)),
            )
        )
        parts = tuple(argument.part for argument in item.arguments)
        found.append((protocol.senders_of(item.message)[0].name, item.message, item.room, parts))
    (place / "shim.c").write_text("".join(programs), encoding="utf-8")
    command = [require_tool("cc"), *FLAGS, "-O1", "-fPIC", "-shared", "shim.c", "-o", "shim.so"]
    done = subprocess.run(command, cwd=place, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    library = ctypes.CDLL(str(place / "shim.so"))
    return [Way(path, sender, it, library, room, parts) for sender, it, room, parts in found]


def calls(prefix: str, fields: Sequence[Field]) -> Iterator[str]:
    """Statements that set each field, and elements that are none."""
    for field in fields:
        function, member = f"{prefix}_{field.name}_set", f"message->{field.name}"
        and_ = "&" if isinstance(field.element, Struct) else ""
        if isinstance(field.type, Array):
            count = f"sizeof {member} / sizeof {member}[0]"
            yield f"    for (size_t i = 0; i < {count}; i++) {{"
            yield f"        TRY({function}_at(payload, i, {and_}{member}[i]))\n    }}"
            yield "    for (size_t shift = 0; shift < 64; shift += 7) {"
            past = f"{count} + (((size_t)1 << shift) - 1U)"
            yield f"        if ({function}_at(payload, {past}, {and_}{member}[0])) {{"
            yield "            return -4;\n        }\n    }"
        else:
            yield f"    TRY({function}(payload, {and_}{member}))"


def reads(prefix: str, fields: Sequence[Field]) -> Iterator[str]:
    """Statements that read numbers and structs again."""
    for field in (it for it in fields if isinstance(it.type, Integer | Float | Struct)):
        member, read = f"message->{field.name}", f"{prefix}_{field.name}_get"
        yield f"        {{\n            __typeof__({member}) found;"
        yield "            memset(&found, 0, sizeof found);"
        call = f"found = {read}(payload)"
        call = f"{read}(payload, &found)" if isinstance(field.type, Struct) else call
        yield f"            {call};"
        yield f"            if (memcmp(&found, &{member}, sizeof found) != 0) {{"
        yield "                return -3;\n            }\n        }"


EVERY_SCHEMA = pytest.mark.parametrize("name", [*FRAMES, *(path.stem for path in SCHEMAS)])


def ways_of(name: str) -> list[Way]:
    path = schema(name) if name in FRAMES else next(it for it in SCHEMAS if it.stem == name)
    return ways(path)


@EVERY_SCHEMA
@settings(max_examples=5)
@given(seed=st.integers(0, 2**32))
def test_frames_written_in_place_are_those_that_python_makes(name: str, seed: int) -> None:
    assert ways_of(name)
    for way in ways_of(name):
        for values, parts in way.samples(Random(seed), 3):
            expected = way.frame(values, parts)
            assert expected is not None
            assert way.write(values, parts) == (OK, expected)


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
                assert made == ((_REFUSED, b"") if expected is None else (OK, expected))
                count += expected is None
    assert count or name in ("elements", "tagged")  # Their bytes may be any.


@EVERY_SCHEMA
def test_a_buffer_that_is_too_short_is_left_alone(name: str) -> None:
    for way in ways_of(name):
        values, parts = way.samples(Random(name), 1)[-1]
        for capacity in (0, way.room - 1):
            assert way.write(values, parts, capacity) == (_NO_ROOM, b"")


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


def test_there_is_nothing_for_messages_that_vary_or_are_short_or_have_no_array() -> None:
    assert [way.message.name for way in ways_of("slip")] == ["turn", "all", "unset"]


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
