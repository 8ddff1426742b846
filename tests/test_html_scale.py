"""The bench of each schema's page against Python: random frames, and every value edited."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import suppress
from itertools import cycle, islice
from pathlib import Path
from random import Random
from typing import Any

import pytest
from amounts import EDITED_ON_A_PAGE, FRAMES_ON_A_PAGE
from browser_pages import Opened, chromium, explained
from page_edits import TRY, editable, edits, mistakes, paths_in
from test_html_page import _EXPLAIN, damaged

from protogen.cli.wire.codec import Codec, open_codec
from protogen.fuzzing.engine import Refused
from protogen.fuzzing.python_engine import PythonEngine
from protogen.fuzzing.samples import Values, boundary_rounds, samples
from protogen.model.messages import Message
from protogen.model.protocol import Sender
from protogen.targets.html.emit import page_text

ROOT = Path(__file__).parents[1]
FOLDERS = ("schemas", "schemas/dialects", "tests/framings", "protogen/library")
SCHEMAS = [path for folder in FOLDERS for path in sorted((ROOT / folder).glob("*.yaml"))]
EDIT_ALL = os.environ.get("PROTOGEN_EDIT_ALL") == "1"
TURN = int(os.environ.get("PROTOGEN_EDIT_TURN", "0"))
"""Which of an endpoint's messages come first; other numbers try others of a large endpoint."""
_TRIED = 40
"""Frames of each message whose values are edited at most."""

_FORM_SIZE = 200
"""Bytes of the longest frame that is put into the form: one of kilobytes has thousands of inputs,
and its elements are all alike."""

Sent = tuple[Sender, Message, bytes]


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    with chromium() as found:
        yield found


def frames_of(codec: Codec, sender: Sender, message: Message) -> Iterator[tuple[Values, bytes]]:
    """Values of a message and their frames, without end: boundaries first, then random ones."""
    random, engine = Random(f"{sender.name} {message.name}"), PythonEngine(codec.runtime)
    for values, parts in samples(message, sender.frame, random):
        with suppress(Refused):
            yield values, engine.frame(sender.name, message.name, values, parts)


def drawn(codec: Codec) -> list[Sent]:
    """Frames of all messages in turn."""
    streams = [
        (sender, message, frames_of(codec, sender, message))
        for sender in codec.protocol.senders
        for message in sender.messages
    ]
    turns = islice(cycle(streams), max(FRAMES_ON_A_PAGE, len(streams)))
    return [(sender, message, next(stream)[1]) for sender, message, stream in turns]


def check_tables(opened: Opened, codec: Codec, sent: list[Sent]) -> None:
    """The rows and events of every example, of the frames, and of damaged ones."""
    random = Random(codec.protocol.name)
    examples = [
        (item.sender, item.bytes)
        for message in codec.protocol.messages
        for item in message.examples
        if item.covers is None
    ]
    frames = [(sender.endpoint, data) for sender, _, data in sent]
    broken = [(endpoint, damaged(data, random)) for endpoint, data in frames[::10]]
    cases = [*examples, *frames, *broken]
    found = opened.run_on_much(_EXPLAIN, [[endpoint, data.hex()] for endpoint, data in cases])
    for (endpoint, data), events in zip(cases, found, strict=True):
        rows = [event["rows"] for event in events]
        assert rows == explained(codec, endpoint, data), f"{endpoint} {data.hex()}"


def check_edits(opened: Opened, codec: Codec, sender: Sender, message: Message) -> None:
    """Every value of a message at its boundaries gives the bytes of the Python encoder."""
    most = min(_TRIED, boundary_rounds(message, sender.frame))
    drawn_frames = [*islice(frames_of(codec, sender, message), most)]
    longest = max(_FORM_SIZE, min(len(data) for _, data in drawn_frames))
    frames = [(values, data) for values, data in drawn_frames if len(data) <= longest]
    frames_hex = [data.hex() for _, data in frames]
    given = [message.name, sender.endpoint, frames_hex, edits(message, sender.frame)]
    made, tried = opened.run_on_much(TRY, given)
    assert mistakes(codec, message, made) == []
    keys = {key.replace("[0]", "[i]") for key in tried}
    lists = {f"{key}[i]" for key in keys}
    present = {path for values, _ in frames for path in paths_in(values)}
    left = {value.path for value in editable(message) if value.path in present} - keys - lists
    assert left == set(), f"{message.name}: no edit of these was tried"


def spread(messages):
    """Some of many messages, evenly, others each day; all where that is asked for."""
    count, most = len(messages), EDITED_ON_A_PAGE
    if EDIT_ALL or count <= most:
        return messages
    return [messages[(index * count // most + TURN) % count] for index in range(most)]


@pytest.mark.parametrize("path", SCHEMAS, ids=lambda path: path.stem)
def test_the_bench_does_as_python_does(browser, tmp_path, path):
    codec = open_codec(path)
    page = tmp_path / "page.html"
    page.write_text(page_text(codec.protocol), encoding="utf-8")
    sent = drawn(codec)
    with Opened(browser, page) as opened:
        check_tables(opened, codec, sent)
        for sender in codec.protocol.senders:
            known = [item for item in sender.messages if sender.received_as(item.name) == item.name]
            for message in spread(known):
                check_edits(opened, codec, sender, message)
        assert opened.complaints == []


def test_the_frames_of_all_schemas_are_ten_thousand():
    assert len(SCHEMAS) * FRAMES_ON_A_PAGE >= 10_000
