"""Every frame and stream that was worked out by hand, through the generated module."""

from __future__ import annotations

import random
from collections.abc import Mapping
from types import ModuleType
from typing import Any

import pytest
from compiled import DOCUMENTS, FRAMINGS, module_at
from vectors import ExpectedEvent, Stream, Vector, VectorFile, read_vectors, vector_files
from vectors.reading import to_bytes

from protogen.runtime.attributes import arguments
from protogen.runtime.values import as_dict

FILES = [read_vectors(path) for path in vector_files()]


def each(kind: str) -> pytest.MarkDecorator:
    """Give a test the parameters `file` and `item`: each vector, or each stream, of each file."""
    items = [(file, item) for file in FILES for item in getattr(file, kind)]
    names = [f"{file.name}-{item.name}" for file, item in items]
    return pytest.mark.parametrize(("file", "item"), items, ids=names)


# --- frames -------------------------------------------------------------------------------------


@each("vectors")
def test_a_frame_is_what_its_values_encode_to(file: VectorFile, item: Vector) -> None:
    module = module_at(file.schema)
    message = message_of(module, item)
    # A vector may show what the schema foresees only as a violation; no strict encoder sends it.
    strict = not message.violations()
    assert module.encode(message, item.sender, strict, **arguments(item.parts)).hex(
        " "
    ) == item.frame.hex(" ")


@each("vectors")
def test_a_frame_decodes_to_its_values(file: VectorFile, item: Vector) -> None:
    module = module_at(file.schema)
    decoded = module.decode(item.frame, item.sender)
    assert decoded.to_dict() == message_of(module, item).to_dict()
    assert agrees(item.values, decoded.to_dict())


@each("vectors")
def test_a_frame_is_one_event_with_its_parts(file: VectorFile, item: Vector) -> None:
    module = module_at(file.schema)
    (event,) = events_of(module, item.sender, [item.frame])
    assert (event.kind, event.offset, event.raw) == ("message", 0, item.frame)
    assert item.message == event.message.NAME
    assert agrees(item.parts, as_dict(event.parts))


def message_of(module: ModuleType, vector: Vector) -> Any:
    return module.MESSAGES[vector.message].from_dict(vector.values)


def agrees(stated: Any, found: Any) -> bool:
    """True if what a vector states is what was found.

    It may leave out keys of a mapping, and may name a number; that the name stands for this number
    is shown by the frame that it encodes to.
    """
    if isinstance(stated, Mapping):
        return all(name in found and agrees(value, found[name]) for name, value in stated.items())
    if isinstance(stated, list):
        return len(stated) == len(found) and all(map(agrees, stated, found))
    return stated == found or (isinstance(stated, str) and isinstance(found, int))


# --- streams ------------------------------------------------------------------------------------


@each("streams")
def test_a_stream_is_cut_into_its_events(file: VectorFile, item: Stream) -> None:
    events = events_of(module_at(file.schema), item.sender, [item.data])
    assert [brief(event) for event in events] == [brief(event) for event in item.events]
    for expected, event in zip(item.events, events, strict=True):
        check_details(expected, event)
    assert b"".join(event.raw for event in events) == item.data


@each("streams")
def test_portions_do_not_change_the_events_of_a_stream(file: VectorFile, item: Stream) -> None:
    module = module_at(file.schema)
    whole = [event.as_json() for event in events_of(module, item.sender, [item.data])]
    for portions in portions_of(item.data):
        found = [event.as_json() for event in events_of(module, item.sender, portions)]
        assert found == whole, portions


def events_of(module: ModuleType, sender: str, portions: list[bytes]) -> list[Any]:
    decoder = module.Decoder(sender=sender)
    events = [event for portion in portions for event in decoder.feed(portion)]
    return [*events, *decoder.flush()]


def brief(event: Any) -> tuple[Any, ...]:
    """Offset, size, kind, and the reason or the message."""
    kind = event.event if isinstance(event, ExpectedEvent) else event.kind
    detail = event.reason if kind == "invalid" else ""
    if kind == "message":
        detail = getattr(event.message, "NAME", event.message)
    return event.offset, event.size, kind, detail


def check_details(expected: ExpectedEvent, event: Any) -> None:
    if expected.parts is not None:
        assert agrees(expected.parts, as_dict(event.parts))
    if expected.payload is not None:
        assert event.payload == expected.payload
    if expected.values is not None:
        assert agrees(expected.values, event.message.to_dict())


def portions_of(data: bytes) -> list[list[bytes]]:
    """The data byte by byte, and at random places cut into portions, some of them empty."""
    dice = random.Random(len(data))
    found = [[bytes((byte,)) for byte in data]]
    for count in (1, 1, 2, 3, 5, 8, 13, 40):
        cuts = sorted(dice.randint(0, len(data)) for _ in range(count))
        ends = [*cuts, len(data)]
        found.append([data[low:high] for low, high in zip([0, *cuts], ends, strict=True)])
    return found


# --- the vectors themselves -----------------------------------------------------------------------


@pytest.mark.parametrize("path", DOCUMENTS, ids=lambda path: path.stem)
def test_every_document_has_ten_frames_and_six_streams(path: Any) -> None:
    file = next(file for file in FILES if file.schema == path)
    assert len(file.vectors) >= 10
    assert len(file.streams) >= 6


@pytest.mark.parametrize("path", DOCUMENTS, ids=lambda path: path.stem)
def test_the_vectors_of_a_document_show_each_of_its_messages(path: Any) -> None:
    file = next(file for file in FILES if file.schema == path)
    shown = {item.message for item in file.vectors}
    shown |= {event.message or "" for item in file.streams for event in item.events}
    encode_only = {"speed", "power_down"}  # of dagny: nothing tells them from another message
    assert set(module_at(path).MESSAGES) - shown - encode_only == set()


@pytest.mark.parametrize("path", FRAMINGS, ids=lambda path: path.stem)
def test_every_framing_has_three_frames_and_three_streams(path: Any) -> None:
    file = next(file for file in FILES if file.schema == path)
    assert len(file.vectors) >= 3
    assert len(file.streams) >= 3


def test_blocks_of_bytes_have_comments_and_repetitions() -> None:
    block = """
        55 AA   # one line of bytes
        # repeat 9: this is a comment
        repeat 3: 01 02     # six bytes
        fF"""
    assert to_bytes(block) == b"\x55\xaa\x01\x02\x01\x02\x01\x02\xff"


@pytest.mark.parametrize(
    "text",
    [
        "schema: s\nvectors: []\nstreams: []\nvektors: []",
        "schema: s\nstreams: []\nvectors:\n- {name: a, sender: b, message: c, frame: '', part: 1}",
        "schema: s\nvectors: []\nstreams:\n- {name: a, sender: b, bytes: '00', events: []}",
        "schema: s\nstreams: []\nvectors:\n- {name: a, sender: b, message: c, frame: ''}\n"
        "- {name: a, sender: b, message: c, frame: ''}",
        "schema: s\nstreams: []\nvectors:\n"
        "- {name: a, sender: b, message: c, frame: '', values: {d: {hex: 10}}}",
    ],
    ids=["unknown key", "unknown key of a vector", "bytes without event", "name twice", "number"],
)
def test_badly_written_vectors_are_refused(tmp_path: Any, text: str) -> None:
    path = tmp_path / "bad.yaml"
    path.write_text(text)
    with pytest.raises(ValueError, match=": "):
        read_vectors(path)
