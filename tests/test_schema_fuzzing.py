"""Random schemas through the whole compiler, and random values and damage through its codecs."""

from __future__ import annotations

import os
import sys
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from types import ModuleType

import pytest
from hypothesis import HealthCheck, Phase, event, given, seed, settings
from hypothesis import strategies as st
from schema_fuzzing import Schema, codec, schemas
from schema_fuzzing.edits import edited, mangled
from schema_fuzzing.shapes import COMMON, PAIRS
from schema_fuzzing.streams import lost, portions, streams
from schema_fuzzing.text import to_styled_yaml, to_yaml
from schema_fuzzing.values import all_parts, parts_of, values_of

from protogen.compiler import Compilation, compile_file
from protogen.model.messages import Message
from protogen.model.protocol import Protocol, Sender
from protogen.problems import Problems, Span, render_text, to_github, to_json
from protogen.runtime.api import DecodeError
from protogen.schema.document import parse_document
from protogen.schema.nodes import to_data
from protogen.targets.python.live import module_of

Compile = Callable[[str], Compilation]

NOWHERE = Span.at("", 1, 1)
STYLES = st.integers(0, 2**32)
THOROUGH = os.environ.get("HYPOTHESIS_PROFILE") == "thorough"
FIXED_SEEDS = 100 if THOROUGH else 8
DRAWS_OF_A_SEED = 30
"""Few, because what is drawn from one seed grows alike."""


@pytest.fixture(scope="module")
def compile_text(tmp_path_factory: pytest.TempPathFactory) -> Compile:
    path = tmp_path_factory.mktemp("schemas") / "drawn.yaml"

    def compile_it(text: str) -> Compilation:
        path.write_text(text, encoding="utf-8", newline="")
        return compile_file(path)

    return compile_it


def valid(compile_text: Compile, schema: Schema) -> Protocol:
    compilation = compile_text(to_yaml(schema.data))
    problems = [f"{item.code} {item.span}: {item.message}" for item in compilation.problems]
    assert not problems, "\n".join([*problems, to_yaml(schema.data)])
    assert compilation.protocol is not None
    return compilation.protocol


# --- (a) valid schemas --------------------------------------------------------------------------


@given(schemas())
def test_valid_schema_compiles_always_to_the_same(compile_text: Compile, schema: Schema) -> None:
    for shape in schema.shapes:
        if " and " in shape:
            event(shape)
    assert valid(compile_text, schema) == valid(compile_text, schema)


@given(schemas(), STYLES)
def test_style_does_not_change_the_model(compile_text: Compile, schema: Schema, style: int) -> None:
    plain = valid(compile_text, schema)
    styled = compile_text(to_styled_yaml(schema.data, style))
    assert not styled.problems
    assert styled.protocol is not None
    assert styled.protocol.spec_hash == plain.spec_hash
    assert without_places(styled.protocol) == without_places(plain)


def without_places(protocol: Protocol) -> Protocol:
    def moved(messages: tuple[Message, ...]) -> tuple[Message, ...]:
        return tuple(replace(message, span=NOWHERE) for message in messages)

    senders = (replace(item, messages=moved(item.messages)) for item in protocol.senders)
    return replace(protocol, messages=moved(protocol.messages), senders=tuple(senders))


@given(schemas(), STYLES)
def test_writer_writes_what_was_drawn(schema: Schema, style: int) -> None:
    for text in (to_yaml(schema.data), to_styled_yaml(schema.data, style)):
        problems = Problems()
        document = parse_document(text, "drawn.yaml", problems)
        assert not list(problems)
        assert document is not None
        assert to_data(document.root) == schema.data


@pytest.fixture(scope="module")
def fixed_draws() -> list[Schema]:
    return [schema for number in range(FIXED_SEEDS) for schema in drawn_from(number)]


def drawn_from(number: int) -> list[Schema]:
    found: list[Schema] = []

    @seed(number)
    @settings(
        max_examples=DRAWS_OF_A_SEED,
        database=None,
        derandomize=False,
        phases=[Phase.generate],
        suppress_health_check=list(HealthCheck),
    )
    @given(schemas())
    def collect(schema: Schema) -> None:
        found.append(schema)

    collect()
    return found


def test_nearly_every_draw_is_valid(compile_text: Compile, fixed_draws: list[Schema]) -> None:
    compilations = [compile_text(to_yaml(schema.data)) for schema in fixed_draws]
    compiled = sum(compilation.protocol is not None for compilation in compilations)
    assert compiled >= 0.9 * FIXED_SEEDS * DRAWS_OF_A_SEED


def test_every_shape_is_drawn(fixed_draws: list[Schema]) -> None:
    found = Counter(shape for schema in fixed_draws for shape in set(schema.shapes))
    for shape, count in sorted(found.items()):
        sys.stdout.write(f"{count:6} {shape}\n")
    expected = {*COMMON, *PAIRS} if THOROUGH else set(COMMON)
    assert not sorted(expected - set(found))


# --- (b) their codecs ---------------------------------------------------------------------------


@contextmanager
def imported(protocol: Protocol) -> Iterator[ModuleType]:
    module = module_of(protocol)
    try:
        yield module
    finally:
        sys.modules.pop(module.__name__, None)


@given(st.data())
def test_values_round_trip_through_payload_and_frame(
    compile_text: Compile, data: st.DataObject
) -> None:
    protocol = valid(compile_text, data.draw(schemas()))
    with imported(protocol) as module:
        for message in protocol.messages:
            made = codec.check_payload(module, message, data.draw(values_of(message)))
            for sender in codec.senders_of(protocol, message):
                _check_frame(data, module, sender, message, made)


def _check_frame(
    data: st.DataObject, module: ModuleType, sender: Sender, message: Message, made: object
) -> None:
    parts = data.draw(parts_of(sender.frame))
    frame = codec.encode(module, sender, message, made, parts)
    event("frame" if frame is not None else "the end would stand in the data")
    if frame is None:
        return
    shown = all_parts(sender.frame, message, parts)
    codec.check_frame(sender, message, frame)
    codec.check_decoded(module, sender, message, frame, made, shown)
    cut = frame[: data.draw(st.integers(0, len(frame) - 1))]
    _check_exact(module, sender, cut)


def _check_exact(module: ModuleType, sender: Sender, data: bytes) -> None:
    """`read` takes exactly one frame, or says why not."""
    try:
        found = module.PROTOCOL.read(data, sender.name)
    except DecodeError as error:
        assert 0 <= error.offset <= len(data)
        return
    assert found.raw == data


@given(st.data())
def test_streams_are_cut_without_loss(compile_text: Compile, data: st.DataObject) -> None:
    protocol = valid(compile_text, data.draw(schemas()))
    with imported(protocol) as module:
        for sender in protocol.senders:
            frames = _frames(data, module, protocol, sender)
            if frames:
                _check_stream(data, module, sender, frames)


def _frames(
    data: st.DataObject, module: ModuleType, protocol: Protocol, sender: Sender
) -> list[bytes]:
    """Some frames of the sender."""
    own = [item for item in protocol.messages if sender in codec.senders_of(protocol, item)]
    found: list[bytes] = []
    for message in data.draw(st.lists(st.sampled_from(own), max_size=4)) if own else []:
        made = module.MESSAGES[message.name].from_dict(data.draw(values_of(message)))
        parts = data.draw(parts_of(sender.frame))
        frame = codec.encode(module, sender, message, made, parts)
        if frame is not None:
            found.append(frame)
    return found


def _check_stream(
    data: st.DataObject, module: ModuleType, sender: Sender, frames: list[bytes]
) -> None:
    stream = data.draw(streams(frames))
    events = codec.events_of(module, sender, [stream.data])
    codec.check_lossless(module, sender, stream.data, events)
    assert codec.events_of(module, sender, data.draw(portions(stream.data))) == events
    assert codec.events_of(module, sender, [bytes((byte,)) for byte in stream.data]) == events
    assert not lost(sender.framing, stream, events), events


@given(st.data())
def test_any_bytes_are_decoded_to_events(compile_text: Compile, data: st.DataObject) -> None:
    protocol = valid(compile_text, data.draw(schemas()))
    with imported(protocol) as module:
        for sender in protocol.senders:
            junk = data.draw(st.binary(max_size=50))
            events = codec.events_of(module, sender, [junk])
            codec.check_lossless(module, sender, junk, events)
            assert codec.events_of(module, sender, data.draw(portions(junk))) == events
            _check_exact(module, sender, junk)


# --- (c) what is wrong --------------------------------------------------------------------------


@given(schemas(), st.data())
def test_edited_schema_has_problems_and_no_traceback(
    compile_text: Compile, schema: Schema, data: st.DataObject
) -> None:
    for _ in range(3):
        text = to_yaml(data.draw(edited(schema.data)))
        _check_problems(compile_text(text), text)


@given(schemas(), STYLES, st.data())
def test_mangled_text_has_problems_and_no_traceback(
    compile_text: Compile, schema: Schema, style: int, data: st.DataObject
) -> None:
    plain = to_styled_yaml(schema.data, style)
    for _ in range(3):
        text = data.draw(mangled(plain))
        _check_problems(compile_text(text), text)


def _check_problems(compilation: Compilation, text: str) -> None:
    """Each problem has a place in the text and can be shown; a protocol can be imported."""
    lines = text.count("\n") + text.count("\r") + 1
    for problem in compilation.problems:
        assert problem.message
        assert problem.span is not None
        assert problem.span.file == compilation.path
        assert 1 <= problem.span.line <= problem.span.end_line <= lines
        assert problem.span.column >= 1
        assert problem.code in render_text(problem, compilation.sources)
        assert problem.code in to_github(problem)
    assert len(to_json(compilation.problems)) == len(compilation.problems)
    assert (compilation.protocol is None) == bool(compilation.errors)
    event(", ".join(sorted({problem.code for problem in compilation.errors})[:2]) or "no problem")
    if compilation.protocol is not None:
        with imported(compilation.protocol) as module:
            assert compilation.protocol.spec_hash == module.SPEC_HASH
