"""Generated TypeScript in node gives the events, messages and frames of Python."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from itertools import islice
from pathlib import Path
from random import Random
from typing import Any

import pytest
import typescript_engine as engine
from compiled import DIALECTS, DOCUMENTS, FRAMINGS, ROOT, module_at, name_of, protocol_of
from corpus import material_of, portions, single_bytes, stream_of
from vectors import VectorFile, read_vectors, vector_files

from protogen.fuzzing.engine import Refused
from protogen.fuzzing.python_engine import PythonEngine
from protogen.fuzzing.trips import Case, cases, told_of

FOLDERS = ("c_schemas", "stuffed_schemas", "form_schemas", "told_schemas")
OTHERS = [path for name in FOLDERS for path in sorted((ROOT / "tests" / name).glob("*.yaml"))]
LIBRARY = sorted((ROOT / "protogen" / "library").glob("*.yaml"))
ALL = [*DOCUMENTS, *DIALECTS, *FRAMINGS, *OTHERS, *LIBRARY]
SCHEMAS = [path for path in ALL if path not in LIBRARY]
FILES = [read_vectors(path) for path in vector_files()]

STREAMS = int(os.environ.get("PROTOGEN_TYPESCRIPT_STREAMS", "40"))
"""Streams of each sender of the documents. With 10,000, there are 100,000 of all of them."""
MANY = 60
"""Messages of a schema in the library of which there are streams."""
AT_ONCE = 500
"""Cases that node is asked about at once."""

of_schema = pytest.mark.parametrize("path", SCHEMAS, ids=name_of)
of_library = pytest.mark.parametrize("path", LIBRARY, ids=name_of)
of_vectors = pytest.mark.parametrize("file", FILES, ids=lambda file: file.name)


@of_vectors
def test_streams_of_the_vectors_are_cut_as_python_cuts_them(file: VectorFile) -> None:
    for item in file.streams:
        for steps in ([item.data, None], [*single_bytes(item.data), None]):
            check_events(file.schema, item.sender, steps)


@of_vectors
def test_frames_of_the_vectors_are_made_and_read(file: VectorFile) -> None:
    protocol, module = protocol_of(file.schema), module_at(file.schema)
    for item in file.vectors:
        record = module.MESSAGES[item.message].from_dict(item.values)
        message = engine.message_of(protocol, item.message, record.to_dict())
        assert made(file.schema, item.sender, message, dict(item.parts)) == item.frame.hex()
        check_events(file.schema, item.sender, [item.frame, None])


def test_a_part_that_differs_from_the_field_is_an_error_with_its_name() -> None:
    path = ROOT / "tests" / "framings" / "part_fields.yaml"
    message = {"message": "answer", "code": 0x82, "text": ""}
    assert made(path, "host", message, {"id": 0x82}) == made(path, "host", message, {})
    answer = made(path, "host", message, {"id": 0x81})
    assert answer == {"path": "id", "problem": "is 130, as the message says, and not 129"}


WIDE = """\
protocol: wide
endpoints: {host: Host, board: Board}
byte_order: little
frame:
  start: {literal: 0xA5, unprotected: plain}
  length: {type: uint8, counts: payload}
  id: {type: uint16, id: true}
  count: {type: uint32, counter: true}
  payload: {}
  check: {type: uint8, algorithm: xor-8, covers: length..payload}
decisions:
  plain: {question: Q, document: D, choice: C, because: B}
messages: {state: {id: 0x1234, from: board, fields: {speed: uint16}}}
"""


def test_parts_that_make_no_small_number_are_those_that_were_sent(tmp_path: Path) -> None:
    path = tmp_path / "wide.yaml"
    path.write_text(WIDE, encoding="utf-8")
    frames = [
        # start, length, identity, counter, speed, exclusive or of all but the start
        bytes.fromhex("A5 02 3412 FFFFFFFF 0100 25"),
        bytes.fromhex("A5 02 3412 00000080 0001 A5"),
    ]
    (found,) = engine.events(engine.module_at(path), "board", [b"".join(frames)])
    assert [event["parts"] for event in found] == [
        {"id": 0x1234, "count": 0xFFFFFFFF},
        {"id": 0x1234, "count": 0x80000000},
    ]


HEADS = """\
protocol: heads
endpoints: {host: Host, board: Board}
byte_order: little
frame:
  start: {literal: 0xAA, unprotected: plain}
  id: {type: uint8, id: true}
  mark: {literal: {hex: "31 32"}}
  length: {type: uint8, counts: length..payload}
  payload: {}
decisions:
  plain: {question: Q, document: D, choice: C, because: B}
messages: {state: {id: 6, from: board, fields: {speed: uint16}}}
"""


@pytest.mark.parametrize(
    "wire",
    [
        "AA 06 33",  # the first byte of a mark that is 31 32
        "AA 06 31 33",  # the second one
        "AA 06 31 32 00",  # a length that counts itself, and so is 1 at least
        "AA 06 31 32 04",  # one of three bytes of payload, where the greatest has two
    ],
)
def test_what_no_frame_begins_with_is_given_up_as_soon_as_in_python(
    wire: str, tmp_path: Path
) -> None:
    path = tmp_path / "heads.yaml"
    path.write_text(HEADS, encoding="utf-8")
    check_events(path, "board", [*single_bytes(bytes.fromhex(wire)), None])


@pytest.mark.parametrize("path", ALL, ids=name_of)
def test_cases_of_the_fuzzer_give_the_same_frames_and_events(path: Path) -> None:
    """What `protogen fuzz --examples 1` tries: all boundaries of all values."""
    found = cases(protocol_of(path), 1, 15)
    while some := list(islice(found, AT_ONCE)):
        check_cases(path, some)


@of_schema
def test_damaged_streams_are_cut_alike(path: Path) -> None:
    check_streams(path, seeds=range(3))


@of_library
def test_damaged_streams_of_the_library_are_cut_alike(path: Path) -> None:
    if len(protocol_of(path).messages) <= MANY:  # Else it takes long to make their frames.
        check_streams(path, seeds=range(1))


@pytest.mark.parametrize("path", DOCUMENTS, ids=name_of)
def test_many_streams_of_the_documents_are_cut_alike(path: Path) -> None:
    check_streams(path, seeds=range(100, 100 + STREAMS))


def check_streams(path: Path, seeds: range) -> None:
    """Streams of each sender, in portions, with a silence somewhere, give the events of Python."""
    for sender in protocol_of(path).senders:
        material = material_of(path, sender.name)
        if not material.frames or sender.plan.greatest > 2048:  # Python takes minutes for noise.
            continue
        for seed in seeds:
            dice = Random(f"{path.stem} {sender.name} {seed}")
            cut: list[bytes | None] = [*portions(stream_of(material, dice, 12).data, dice)]
            cut.insert(dice.randint(0, len(cut)), None)
            check_events(path, sender.name, [*cut, None])


def check_events(path: Path, sender: str, steps: engine.Steps) -> None:
    """Each step gives the events of Python, so that none comes earlier or later."""
    found = engine.events(engine.module_at(path), sender, steps)
    difference = engine.first_difference(
        found, engine.python_events(module_at(path), sender, steps)
    )
    if difference:
        pytest.fail(difference, pytrace=False)


def check_cases(path: Path, some: list[Case]) -> None:
    """Each case gives the frame of Python, or none, and the frame its message and its events."""
    protocol, module = protocol_of(path), module_at(path)
    python = PythonEngine(module.PROTOCOL, module.encode)
    requests: list[dict[str, Any]] = []
    due: list[Any] = []
    for case in some:
        sender = protocol.sender(case.sender)
        values = module.MESSAGES[case.message].from_dict(case.values).to_dict()
        message = engine.message_of(protocol, case.message, values)
        parts = marked(case.parts)
        requests.append({"message": message, "parts": parts, "sender": sender.name})
        try:
            frame = python.frame(case.sender, case.message, case.values, case.parts)
        except Refused:
            due.append((case, "refused", None))
            continue
        received = {"sender": sender.endpoint, "told": told_of(sender, case, frame)}
        requests.append({"frame": frame.hex(), **received, "sender": sender.name})
        requests.append({"steps": [frame.hex(), None], **received})
        events = engine.python_events(module, steps=[frame, None], **received)
        (event,) = (event for step in events for event in step)
        due += [
            (case, "frame", frame.hex()),
            (case, event["event"], None),
            (case, "events", events),
        ]
    answers = engine.node().ask(engine.module_at(path), several=requests)
    for (case, what, expected), answer in zip(due, answers, strict=True):
        if what in ("refused", "unknown"):
            assert "problem" in answer, case
        elif what == "events":
            lines = [[json.loads(line) for line in step] for step in answer]
            assert not engine.first_difference(lines, expected), case
        else:
            assert answer == {"found": expected}, (case, what)


def made(path: Path, sender: str, message: dict[str, Any], parts: dict[str, Any]) -> Any:
    """The frame that TypeScript makes, as digits, or its error."""
    request = {"message": message, "sender": sender, "parts": marked(parts), "strict": False}
    answer = engine.node().ask(engine.module_at(path), **request)
    return answer.get("found", answer)


def marked(parts: Mapping[str, Any]) -> dict[str, Any]:
    """Parts for a request, which says what is a bigint."""
    return {
        name: {"$big": str(value)} if isinstance(value, int) and value >= 1 << 53 else value
        for name, value in parts.items()
    }
