"""Schemas that nobody writes by accident: each is refused in good time, and none compiles."""

from __future__ import annotations

import signal
import sys
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from types import CodeType, FrameType
from typing import Any

import pytest
from passes_support import HEAD, compile_text, protocol_of

import protogen
from protogen.targets import TARGETS

SLIP = "frame: {id: {type: uint8, id: true}, payload: {}, end: {literal: 0xC0}}\n"
FRAMED = HEAD + SLIP + "transparency: slip\n"
MESSAGE = "messages: {gyro: {id: 1, from: robot, fields: {angle: uint8}}}\n"
SECONDS = 10
PACKAGE = str(Path(protogen.__file__).parent)


def with_field(field: str, more: str = "") -> str:
    return FRAMED + more + f"messages: {{gyro: {{id: 1, from: robot, fields: {{{field}}}}}}}\n"


def with_messages(messages: str) -> str:
    return FRAMED + f"messages: {{{messages}}}\n"


def with_frame(parts: str, more: str = "", messages: str = MESSAGE) -> str:
    return HEAD + f"frame: {{{parts}}}\n" + more + messages


def with_transparency(transparency: str) -> str:
    return HEAD + SLIP + f"transparency: {transparency}\n" + MESSAGE


def chain(names: int, fields: str) -> str:
    """Declared types of which each holds the next one."""
    types = (f"t{number}: {{fields: {{{fields}}}}}" for number in range(names))
    numbered = (text.replace("NEXT", f"t{number + 1}") for number, text in enumerate(types))
    return f"types: {{{', '.join(numbered)}, t{names}: uint8}}\n"


@contextmanager
def in_good_time() -> Iterator[None]:
    """Fail instead of waiting for a compiler that does not end."""

    def late(signum: int, frame: FrameType | None) -> None:
        raise AssertionError(f"the compiler took more than {SECONDS} s")

    before = signal.signal(signal.SIGALRM, late)
    signal.alarm(SECONDS)
    try:
        yield
    finally:
        signal.alarm(0)
        signal.signal(signal.SIGALRM, before)


HOSTILE = {
    # Numbers that are no numbers, or too large to compute with
    "huge exponent": with_field("a: {type: uint8, scale: 1e999999999}"),
    "tiny exponent": with_field("a: {type: uint8, offset: 1e-999999999}"),
    "division by a zero of another script": with_field('a: {type: uint8, scale: "1/\u0660"}'),
    "float constant of 399 digits": with_field(f"a: {{type: float32, const: {'9' * 399}}}"),
    "width of 5000 digits": with_field("a: uint" + "9" * 5000),
    "part of 5000 digits": with_frame("id: {type: uint" + "9" * 5000 + ", id: true}, payload: {}"),
    "width of zero": with_field("a: uint0"),
    "width of 65": with_field("a: sint65"),
    "negative bit": with_field("a: {type: uint8, bits: {x: -1, y: 0}}"),
    # Types that are small to write and large to build
    "types that double": with_field("a: t0", chain(40, "x: NEXT, y: NEXT")),
    "types 2000 deep": with_field("a: t0", chain(2000, "x: NEXT")),
    "arrays of arrays": with_field("a: t0", chain(300, "x: {type: NEXT, count: 1000}")),
    "overload of endless sizes": with_messages(
        "a: {id: 1, from: robot, fields: {n: uint64, x: {type: uint16, count: n}}}, "
        "b: {id: 1, from: robot, fields: {n: uint64, z: uint8, x: {type: uint16, count: n}}}"
    )
    + "overloads: {o: {messages: [a, b], by: size}}\n",
    # Bytes that are none
    "substitution of 511": with_transparency("{substitute: {511: [1, 2]}}"),
    "substitution of -1": with_transparency("{substitute: {-1: [1, 2]}}"),
    "escape byte 300": with_transparency("{escape: {byte: 300, of: [300], transform: none}}"),
    "escaped byte 300": with_transparency("{escape: {byte: 3, of: [3, 300], transform: none}}"),
    "XOR with 300": with_transparency("{escape: {byte: 3, of: [3, 0xC0], transform: {xor: 300}}}"),
    "text that is nothing": with_frame(
        "id: {type: uint8, id: true}, payload: {}, end: {literal: {text: }, unprotected: why}",
        "decisions: {why: {question: Q, document: D, choice: C, because: B}}\n",
    ),
    "character that is no byte": with_field('a: {type: char, const: "€"}'),
    "list of numbers and texts": with_field('a: {type: uint8, count: 2, const: [1, "a", 3]}'),
    # Messages and frames of nothing
    "no sender": with_messages("a: {id: 1, from: []}"),
    "no identity": with_messages("a: {from: robot}, b: {from: robot}"),
    "identity of another part": with_messages("a: {id: {idd: 1}, from: robot}"),
    "identity of no part": with_messages("a: {id: {}, from: robot}"),
    "identity too large": with_messages("a: {id: 300, from: robot}"),
    "identity too small": with_messages("a: {id: -1, from: robot}"),
    "frame of no bytes": with_frame(
        "payload: {}, check: {type: uint8, algorithm: xor-8, covers: payload, when: payload}",
        "link: {baud: 9600}\n",
        "messages: {gyro: {from: robot}}\n",
    ),
    "length of nothing": with_frame(
        "id: {type: uint8, id: true}, length: {type: uint8, counts: []}, payload: {}, "
        "check: {type: uint8, algorithm: xor-8, covers: id..payload}"
    ),
    "checksum of nothing": with_frame(
        "id: {type: uint8, id: true}, length: {type: uint8, counts: payload}, payload: {}, "
        "check: {type: uint8, algorithm: xor-8, covers: []}"
    ),
    "transparency of nothing": with_frame(
        "id: {type: uint8, id: true}, length: {type: uint8, counts: payload}, payload: {}, "
        "check: {type: uint8, algorithm: xor-8, covers: id..payload}",
        "transparency: {preset: slip, covers: []}\n",
    ),
    "one bad frame for two senders": with_frame(
        "length: {counts: payload}, id: {type: uint8, id: true}, payload: {}, end: {literal: 3}",
        "transparency: slip\n",
        "messages: {a: {id: 1, from: robot}, b: {id: 1, from: host}}\n",
    ),
    "checksums of each other": with_frame(
        "id: {type: uint8, id: true}, length: {type: uint8, counts: payload}, payload: {}, "
        "one: {type: uint8, algorithm: xor-8, covers: [payload, two]}, "
        "two: {type: uint8, algorithm: sum-8, covers: [payload, one]}"
    ),
    # Keys that would be passed over in silence
    "array of switches": with_field("k: uint8, a: {switch: k, count: 5, cases: {0: uint8}}"),
    "flags of a struct": with_field("a: {fields: {b: uint8}, flags: {x: 0}}"),
    "values of a text": with_field("a: {type: ascii, size: 4, values: {x: 1}}"),
    "cases without a switch": with_field("a: {type: uint8, cases: {1: uint8}}"),
}


@pytest.mark.parametrize("text", HOSTILE.values(), ids=HOSTILE.keys())
def test_is_refused_in_good_time(text: str) -> None:
    with in_good_time():
        compiled = compile_text(text)
    assert compiled.errors
    assert compiled.protocol is None


def test_a_transparency_by_sender_holds_for_a_frame_of_all() -> None:
    messages = "messages: {a: {id: 1, from: robot}, b: {id: 1, from: host}}\n"
    by_sender = "transparency: {robot: slip, host: slip}\n"
    assert compile_text(HEAD + SLIP + by_sender + messages).problems == ()


@pytest.mark.parametrize("step", ["compile", *TARGETS])
def test_the_work_grows_with_the_messages_and_types(step: str) -> None:
    """In every function: twice the lines run for twice as many, not four times."""
    small, middle, large = (_lines_run(_work(step, count)) for count in (10, 20, 40))
    grown = {code: (middle[code] - small[code], large[code] - middle[code]) for code in large}
    slow = [code for code, (before, then) in grown.items() if then > 2.5 * before + 40]
    assert slow == []


def _work(step: str, count: int) -> Callable[[], object]:
    numbers = range(count)
    text = with_frame(
        "id: {type: uint16, id: true}, length: {type: uint8, counts: payload}, payload: {}, "
        "crc: {type: uint16, algorithm: CRC-16/KERMIT, covers: id..payload}",
        "".join(["types:\n", *(f"  e{n}: {{type: uint8, values: {{a: 0}}}}\n" for n in numbers)]),
        "".join(["messages:\n", *(_message(n) for n in numbers)]),
    )
    if step == "compile":
        return lambda: compile_text(text)
    protocol = protocol_of(text)
    return lambda: TARGETS[step].emit([protocol])


def _message(n: int) -> str:
    fields = (
        f"mode: e{n}, a: {{type: uint8, count: {n + 1}}}, b: uint8, text: {{type: ascii, size: b}}"
    )
    return f"  m{n}: {{id: {n}, from: robot, fields: {{{fields}}}}}\n"


def _is_ours(code: CodeType) -> bool:
    """Whether code is the compiler's. Python calls others' when it likes, as for garbage."""
    return code.co_filename.startswith(PACKAGE)


def _lines_run(work: Callable[[], object]) -> Counter[CodeType]:
    lines: Counter[CodeType] = Counter()

    def trace(frame: FrameType, event: str, _argument: object) -> Any:
        if not _is_ours(frame.f_code):
            return None
        lines[frame.f_code] += event == "line"
        return trace

    before = sys.gettrace()
    work()  # fills caches
    sys.settrace(trace)
    try:
        work()
    finally:
        sys.settrace(before)
    return lines
