"""The decoders of generated C, held against Python's: the same events of the same steps."""

from __future__ import annotations

from collections.abc import Iterable
from itertools import chain
from pathlib import Path
from random import Random
from types import ModuleType
from typing import Any

import handwritten_streams
import pytest
from amounts import OF_TWO_ENGINES, STREAMS_OF_TWO_ENGINES
from c_engine import (
    Process,
    assert_same_steps,
    check_events,
    process_of,
)
from compiled import DOCUMENTS, ROOT, SCHEMAS, covering, module_at, name_of, protocol_of
from corpus import joined, marks_of, material_of, portions, stream_of
from hypothesis import given, settings
from hypothesis import strategies as st
from test_recovery import drawn_pieces
from test_vectors import FILES, agrees, brief, message_of
from vectors import ExpectedEvent, Stream, Vector, VectorFile

from protogen.copying import replace
from protogen.fuzzing.c_calls import OK, CEvent, Step
from protogen.live.codec import module_of
from protogen.model.messages import Message, given_parts
from protogen.model.protocol import Sender
from protogen.passes.selection import select
from protogen.targets.c.options import EVENTS, COptions

ALL = COptions()
MESSAGES = COptions(events="messages")
SAMPLERS = sorted((ROOT / "tests" / "c_schemas").glob("*.yaml"))
SENDERS = [
    (path, sender.name) for path in (*SCHEMAS, *SAMPLERS) for sender in protocol_of(path).senders
]
EVERY_SENDER = pytest.mark.parametrize(("path", "sender"), SENDERS, ids=name_of)
OTHER_PATHS = {
    *covering(),
    *(path for path in SAMPLERS if path.stem in ("sampler", "part_bits", "mirrors", "measured")),
}
"""Schemas whose decoders without events of bytes that are no message are tried, too."""
OTHERS = [(path, sender) for path, sender in SENDERS if path in OTHER_PATHS]
SOME_SENDERS = pytest.mark.parametrize(("path", "sender"), OTHERS, ids=name_of)
BUILDS = [
    *(pytest.param(ALL, *sender, id=f"all-{name_of(sender[0])}-{sender[1]}") for sender in SENDERS),
    *(
        pytest.param(MESSAGES, *sender, id=f"messages-{name_of(sender[0])}-{sender[1]}")
        for sender in OTHERS
    ),
]
SEEDS = range(STREAMS_OF_TWO_ENGINES)
PIECES = 40


# --- steps ----------------------------------------------------------------------------------------


def steps_of(data: bytes, dice: Random) -> list[Step]:
    """The data in random portions, fed or pushed, now and then with a silence between them."""
    found: list[Step] = []
    for portion in portions(data, dice):
        found.append(("feed" if dice.random() < 0.5 else "push", portion))
        if dice.random() < 0.05:
            found.append(("flush",))
    return [*found, ("flush",)]


def check_corpus(process: Process, module: ModuleType, sender: str, path: Path) -> None:
    """Streams of frames, damaged frames and noise."""
    material = material_of(path, sender)
    for seed in SEEDS:
        dice = Random(f"{path.stem} {sender} {seed}")
        stream = stream_of(material, dice, PIECES)
        check_events(process, module, sender, steps_of(stream.data, dice))


# --- all events -----------------------------------------------------------------------------------


@EVERY_SENDER
def test_a_stream_has_the_events_that_python_finds(path: Path, sender: str) -> None:
    check_corpus(process_of(path), module_at(path), sender, path)


@EVERY_SENDER
def test_a_stream_of_telling_bytes_has_the_events_that_python_finds(
    path: Path, sender: str
) -> None:
    """Delimiters, escapes, identities and lengths without any frame."""
    marks = marks_of(path, sender)
    for seed in SEEDS:
        dice = Random(f"{path.stem} {sender} {seed}")
        data = bytes(dice.choice(marks) for _ in range(dice.randrange(400)))
        check_events(process_of(path), module_at(path), sender, steps_of(data, dice))


@EVERY_SENDER
def test_short_payloads_of_any_kind_have_the_events_that_python_finds(
    path: Path, sender: str
) -> None:
    spec = module_at(path).PROTOCOL.sender(sender)
    for seed in SEEDS:
        dice = Random(f"{path.stem} {sender} {seed}")
        data = handwritten_streams.random_stream(spec, dice, 20)
        check_events(process_of(path), module_at(path), sender, steps_of(data, dice))


@EVERY_SENDER
@settings(max_examples=OF_TWO_ENGINES)
@given(data=st.data())
def test_any_mixture_has_the_events_that_python_finds(
    path: Path, sender: str, data: st.DataObject
) -> None:
    mixture = drawn_pieces(material_of(path, sender))
    streams = [joined(data.draw(mixture)).data for _ in range(data.draw(st.integers(1, 2)))]
    steps = list(chain.from_iterable(data.draw(drawn_steps(stream)) for stream in streams))
    check_events(process_of(path), module_at(path), sender, steps)


@st.composite
def drawn_steps(draw: st.DrawFn, data: bytes) -> list[Step]:
    """The data in portions, and the end of it."""
    cuts = sorted(draw(st.lists(st.integers(0, len(data)), max_size=5)))
    kind = draw(st.sampled_from(["feed", "push"]))
    ends = [*cuts, len(data)]
    parts = [data[low:high] for low, high in zip([0, *cuts], ends, strict=True)]
    return [*((kind, part) for part in parts), ("flush",)]


@pytest.mark.parametrize(("options", "path", "sender"), BUILDS)
def test_a_decoder_in_memory_of_zeros_is_like_one_that_was_initialised(
    options: COptions, path: Path, sender: str
) -> None:
    """Delimiters and frames where the input begins, which is when the two could differ."""
    marks = sorted(set(marks_of(path, sender)))
    dice = Random(f"{path.stem} {sender}")
    starts = [
        bytes((one, other)) for one in marks for other in dice.sample(marks, min(4, len(marks)))
    ]
    starts += [bytes((value,)) for value in range(256)]
    frames = dice.choices(material_of(path, sender).frames, k=20)
    starts += [*frames, *(frame[1:] + frame for frame in frames)]
    steps: list[Step] = []
    for start in starts:
        kind = "feed" if dice.random() < 0.5 else "push"
        steps += [("clear",), (kind, start), ("flush",)]
    check_events(process_of(path, options), module_at(path), sender, steps)


def test_offsets_count_on_beyond_the_end_of_an_input() -> None:
    path, sender = DOCUMENTS[0], protocol_of(DOCUMENTS[0]).senders[0].name
    frame = material_of(path, sender).frames[0]
    steps: list[Step] = [("feed", frame), ("flush",)] * 3
    process = process_of(path)
    events = list(chain.from_iterable(process.do(process.calls.events(sender, steps))))
    assert [event.offset for event in events] == [0, len(frame), 2 * len(frame)]


# --- other builds ---------------------------------------------------------------------------------


@SOME_SENDERS
def test_the_messages_alone_are_those_that_python_finds(path: Path, sender: str) -> None:
    check_corpus(process_of(path, MESSAGES), module_at(path), sender, path)


@SOME_SENDERS
def test_the_messages_alone_in_streams_of_telling_bytes(path: Path, sender: str) -> None:
    spec = module_at(path).PROTOCOL.sender(sender)
    for seed in SEEDS:
        dice = Random(f"{path.stem} {sender} {seed}")
        data = handwritten_streams.random_stream(spec, dice, 20)
        check_events(process_of(path, MESSAGES), module_at(path), sender, steps_of(data, dice))


@pytest.mark.parametrize("path", DOCUMENTS, ids=name_of)
def test_a_single_header_decodes_alike(path: Path) -> None:
    """It has the same code, as test_c_lint.py shows of all schemas."""
    process = Process(protocol_of(path), COptions(style="single"))
    for sender in protocol_of(path).senders:
        check_corpus(process, module_at(path), sender.name, path)
    process.close()


# --- selections -----------------------------------------------------------------------------------


def selections() -> list[tuple[Path, tuple[str, ...] | None, tuple[str, ...] | None]]:
    """Of each document: one message, every other one, those of one sender, the small ones."""
    found: list[tuple[Path, tuple[str, ...] | None, tuple[str, ...] | None]] = []
    for path in DOCUMENTS:
        protocol = protocol_of(path)
        names = [message.name for message in protocol.messages]
        small = [m.name for m in protocol.messages if m.sizes.greatest <= 8]
        chosen = [tuple(names[:1]), tuple(names[::2]), tuple(small)]
        found += [(path, only, None) for only in dict.fromkeys(filter(None, chosen))]
        found += [(path, None, (protocol.senders[-1].name,))]
    return found


@pytest.mark.parametrize(
    ("path", "only", "senders", "events"),
    [(*chosen, EVENTS[number % 2]) for number, chosen in enumerate(selections())],
    ids=str,
)
def test_a_selection_decodes_as_the_same_selection_does_in_python(
    path: Path, only: tuple[str, ...] | None, senders: tuple[str, ...] | None, events: Any
) -> None:
    """Members that are left out are unknown; a length beyond what is left is wrong."""
    process = Process(protocol_of(path), COptions(only=only, senders=senders, events=events))
    protocol = select(protocol_of(path), only, senders)
    module = module_of(protocol)
    for sender in protocol.senders:
        check_corpus(process, module, sender.name, path)
        assert len(process.driver.messages) == len(protocol.messages)
    process.close()


def test_frames_of_one_size_are_those_that_python_finds() -> None:
    """Their decoder keeps in one number how much it has, and that an escape came."""
    path = ROOT / "schemas" / "matty.yaml"
    only = ("status",)
    process = Process(protocol_of(path), COptions(only=only, events="messages"))
    module = module_of(select(protocol_of(path), only, None))
    check_corpus(process, module, "esp", path)
    spec = module.PROTOCOL.sender("esp")
    for seed in SEEDS:
        dice = Random(f"matty status {seed}")
        data = handwritten_streams.random_stream(spec, dice, 20)
        check_events(process, module, "esp", steps_of(data, dice))
    process.close()


# --- what was worked out by hand ------------------------------------------------------------------


def each(kind: str) -> pytest.MarkDecorator:
    every = ((file, item) for file in FILES for item in getattr(file, kind))
    items = [(file, item) for file, item in every if is_of_one_form(file, item.sender)]
    names = [f"{file.name}-{item.name}" for file, item in items]
    return pytest.mark.parametrize(("file", "item"), items, ids=names)


def is_of_one_form(file: VectorFile, sender: str) -> bool:
    """C has a decoder for each form of frame, Python one for all of them as well."""
    return any(item.name == sender for item in protocol_of(file.schema).senders)


@each("vectors")
def test_a_frame_by_hand_is_made_and_read(file: VectorFile, item: Vector) -> None:
    process = process_of(file.schema)
    message = message_of(module_at(file.schema), item)
    protocol = protocol_of(file.schema)
    parts = parts_of(protocol.sender(item.sender), protocol.message(item.message), item.parts)
    if not message.violations():
        call = process.calls.frame(item.sender, item.message, message.to_dict(), parts)
        made = process.do(call)
        assert (made.result, made.data.hex(" ")) == (OK, item.frame.hex(" "))
    (event,) = events_of(process, item.sender, [("feed", item.frame), ("flush",)])
    assert (event.kind, event.offset, event.size) == ("message", 0, len(item.frame))
    assert agrees(item.parts, event.parts)
    assert event.message == item.message
    assert agrees(item.values, event.values)


def parts_of(sender: Sender, message: Message, given: Any) -> dict[str, int]:
    """The given parts, and what the others are where nobody says."""
    defaults: dict[str, Any] = {
        part.name: value
        for part, value in zip(sender.frame.identity, message.identity, strict=True)
        if part in given_parts(sender.frame, message)
    }
    defaults |= {part.name: part.default for part in sender.frame.caller_parts}
    known = {part.name: part for part in (*sender.frame.identity, *sender.frame.caller_parts)}
    return {
        name: given.get(name, known[name].shown(default or 0)) for name, default in defaults.items()
    }


@each("streams")
def test_a_stream_by_hand_is_cut_into_its_events(file: VectorFile, item: Stream) -> None:
    process = process_of(file.schema)
    for kind in ("feed", "push"):
        steps: list[Step] = [(kind, item.data), ("flush",)]
        events = events_of(process, item.sender, steps)
        assert list(map(shown, events)) == list(map(brief, item.events))
        for expected, event in zip(item.events, events, strict=True):
            check_details(expected, event)


def events_of(process: Process, sender: str, steps: Iterable[Step]) -> list[CEvent]:
    return list(chain.from_iterable(process.do(process.calls.events(sender, steps))))


def shown(event: CEvent) -> tuple[Any, ...]:
    """Offset, size, kind, and the reason or the message."""
    return event.offset, event.size, event.kind, event.reason or event.message


def check_details(expected: ExpectedEvent, event: CEvent) -> None:
    if expected.parts is not None:
        assert agrees(expected.parts, event.parts)
    if expected.payload is not None:
        assert event.payload == expected.payload
    if expected.values is not None:
        assert agrees(expected.values, event.values)


# --- the comparison itself ------------------------------------------------------------------------


def test_events_that_differ_are_told_apart() -> None:
    event = CEvent("message", 0, 5, "", "go", {"counter": 1}, b"\x01", {"x": "nan"})
    assert_same_steps([[event]], [[event]])
    others = [{"offset": 1}, {"size": 4}, {"message": "no"}, {"payload": b""}, {"values": {"x": 1}}]
    for other in others:
        with pytest.raises(pytest.fail.Exception, match="step 0"):
            assert_same_steps([[event]], [[replace(event, **other)]])
    with pytest.raises(pytest.fail.Exception, match="step 0"):
        assert_same_steps([[event], []], [[], [event]])
