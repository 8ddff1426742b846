"""Random schemas through the whole compiler, and random values and damage through its codecs."""

from __future__ import annotations

import sys
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from types import ModuleType
from typing import Any

import pytest
from amounts import SCHEMAS_IN_PYTHON, THOROUGH
from hypothesis import HealthCheck, Phase, event, given, seed, settings
from hypothesis import strategies as st
from schema_fuzzing import Schema, codec, schemas
from schema_fuzzing.account import Account
from schema_fuzzing.edits import edited, mangled
from schema_fuzzing.examples import MORE, Sent, with_examples
from schema_fuzzing.held import held_parts
from schema_fuzzing.shapes import COMMON, PAIRS
from schema_fuzzing.streams import lost, portions, streams
from schema_fuzzing.text import to_styled_yaml, to_yaml
from schema_fuzzing.values import parts_of, values_of

from protogen.compiler import Compilation, compile_file
from protogen.copying import replace
from protogen.examples import verify_examples
from protogen.live.codec import module_of
from protogen.model.frame_plan import FramePlan
from protogen.model.messages import Message
from protogen.model.payload_plan import ChooseStep, every_step
from protogen.model.protocol import Protocol, Sender
from protogen.problems import Problems, Span, render_text, to_github, to_json
from protogen.runtime.api import DecodeError
from protogen.runtime.attributes import arguments
from protogen.schema.text.document import parse_document
from protogen.schema.text.nodes import to_data

Compile = Callable[[str], Compilation]

NOWHERE = Span.at("", 1, 1)
STYLES = st.integers(0, 2**32)
EDITED = 50
"""Schemas that are spoilt, each of them several times."""
STYLED = 25
EXAMPLED = 25
EDITS_OF_EACH = 3
FIXED_SEEDS = 100 if THOROUGH else 24
DRAWS_OF_A_SEED = 30
"""Few, because what is drawn from one seed grows alike."""


def examples(count: int) -> settings:
    """So many examples, or in the thorough profile as many as it says.

    To explain a failure takes longer than all examples, and says little about so large a drawing.
    """
    return settings(
        max_examples=settings().max_examples if THOROUGH else count,
        phases=[phase for phase in Phase if phase is not Phase.explain],
    )


ALONGSIDE = 0.4
"""Share of all keys that stand in the same schema as one of them, in some draw."""

MEANT_OTHERWISE = {"PG124", "PG126"}
"""Codes of warnings about valid schemas: leading zeros, and short names of checksums."""


@pytest.fixture(scope="module")
def compile_text(tmp_path_factory: pytest.TempPathFactory) -> Compile:
    path = tmp_path_factory.mktemp("schemas") / "drawn.yaml"

    def compile_it(text: str) -> Compilation:
        path.write_text(text, encoding="utf-8", newline="")
        return compile_file(path)

    return compile_it


def valid(compile_text: Compile, schema: Schema) -> Protocol:
    compilation = compile_text(to_yaml(schema.data))
    wrong = [item for item in compilation.problems if item.code not in MEANT_OTHERWISE]
    problems = [f"{item.code} {item.span}: {item.message}" for item in wrong]
    assert not problems, "\n".join([*problems, to_yaml(schema.data)])
    assert compilation.protocol is not None
    return compilation.protocol


# --- (a) valid schemas --------------------------------------------------------------------------


@examples(STYLED)
@given(schemas(), STYLES)
def test_model_depends_on_what_is_written_and_not_on_its_style(
    compile_text: Compile, schema: Schema, style: int
) -> None:
    plain, styled = to_yaml(schema.data), to_styled_yaml(schema.data, style)
    for text in (plain, styled):
        assert _read(text) == schema.data
    model = valid(compile_text, schema)
    assert valid(compile_text, schema) == model
    again = compile_text(styled)
    assert {problem.code for problem in again.problems} <= MEANT_OTHERWISE
    assert again.protocol is not None
    assert again.protocol.spec_hash == model.spec_hash
    assert without_places(again.protocol) == without_places(model)


def _read(text: str) -> object:
    problems = Problems()
    document = parse_document(text, "drawn.yaml", problems)
    assert not list(problems)
    assert document is not None
    return to_data(document.root)


def without_places(protocol: Protocol) -> Protocol:
    def moved(messages: tuple[Message, ...]) -> tuple[Message, ...]:
        return tuple(replace(message, span=NOWHERE) for message in messages)

    def planned(plan: FramePlan) -> FramePlan:
        groups = (replace(group, messages=moved(group.messages)) for group in plan.groups)
        return replace(plan, groups=tuple(groups))

    senders = (
        replace(item, messages=moved(item.messages), plan=planned(item.plan))
        for item in protocol.senders
    )
    return replace(protocol, messages=moved(protocol.messages), senders=tuple(senders))


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


@pytest.mark.usefixtures("fixed_draws")
def test_every_shape_and_every_key_of_the_language_is_drawn() -> None:
    """Whether drawn schemas are valid is asked where they are tried, of each.

    The keys, the forms of their values and the words that may stand there are those of the JSON
    Schema. What is rare is drawn from a few seeds more.
    """
    shapes, account = Counter[str](), Account()
    expected = {*COMMON, *PAIRS} if THOROUGH else set(COMMON)
    for number in range(4 * FIXED_SEEDS):
        drawn = drawn_from(number)
        assert len(drawn) >= DRAWS_OF_A_SEED // 2
        shapes.update(shape for schema in drawn for shape in set(schema.shapes))
        for schema in drawn:
            account.add(schema.data)
        if number + 1 >= FIXED_SEEDS and expected <= shapes.keys() and not account.missing:
            break
    for name, count in sorted((shapes + account.counted).items()):
        sys.stdout.write(f"{count:6} {name}\n")
    assert not sorted(expected - shapes.keys())
    assert not account.missing, "draw them in tests/schema_fuzzing"
    assert not account.lonely(ALONGSIDE), "draw them together with other keys"


# --- (b) their codecs ---------------------------------------------------------------------------


@contextmanager
def imported(protocol: Protocol) -> Iterator[ModuleType]:
    module = module_of(protocol)
    try:
        yield module
    finally:
        sys.modules.pop(module.__name__, None)


@examples(SCHEMAS_IN_PYTHON)
@given(schemas(), st.data())
def test_schema_compiles_and_its_codec_works(
    compile_text: Compile, schema: Schema, data: st.DataObject
) -> None:
    for shape in schema.shapes:
        if " and " in shape:
            event(shape)
    protocol = valid(compile_text, schema)
    with imported(protocol) as module:
        frames = _check_values(data, module, protocol)
        for sender in protocol.senders:
            if frames[sender.name]:
                _check_stream(data, module, sender, frames[sender.name])
            _check_any_bytes(data, module, sender)
        for endpoint in protocol.sending:
            if len(protocol.forms(endpoint)) > 1:
                _check_mixture(data, module, endpoint, protocol.forms(endpoint), frames)
        if len(protocol.sending) > 1 and _are_found_alike(module):
            _check_mixture(data, module, None, protocol.senders, frames)


def _check_values(
    data: st.DataObject, module: ModuleType, protocol: Protocol
) -> dict[str, list[bytes]]:
    """Values go through payload and frame; the frames by sender."""
    frames: dict[str, list[bytes]] = {sender.name: [] for sender in protocol.senders}
    for message in protocol.messages:
        frames_of = [sender.frame for sender in protocol.senders_of(message)]
        made = codec.check_payload(module, message, data.draw(values_of(message, frames_of)))
        if made is None:
            continue
        for sender in codec.senders_of(protocol, message):
            frame = _check_frame(data, module, sender, message, made)
            frames[sender.name] += [] if frame is None else [frame]
    return frames


def _check_frame(
    data: st.DataObject, module: ModuleType, sender: Sender, message: Message, made: Any
) -> bytes | None:
    parts = data.draw(parts_of(sender.frame, message))
    frame = codec.encode(module, sender, message, made, parts)
    event("frame" if frame is not None else "the end would stand in the data")
    if frame is None:
        return None
    shown = codec.shown_parts(sender, message, made, parts)
    codec.check_frame(sender, message, frame)
    codec.check_decoded(module, sender, message, frame, made, shown)
    _check_exact(module, sender, frame[: data.draw(st.integers(0, len(frame) - 1))])
    return frame


def _check_exact(module: ModuleType, sender: Sender, data: bytes) -> None:
    """`read` takes exactly one frame, or says why not."""
    try:
        found = module.PROTOCOL.read(data, sender.name)
    except DecodeError as error:
        assert 0 <= error.offset <= len(data)
        return
    assert found.raw == data


def _check_stream(
    data: st.DataObject, module: ModuleType, sender: Sender, frames: list[bytes]
) -> None:
    sent = data.draw(st.lists(st.sampled_from(frames), min_size=1, max_size=4))
    stream = data.draw(streams(sent))
    events = codec.events_of(module, sender, [stream.data])
    codec.check_lossless(module, [sender], stream.data, events)
    reference = codec.events_of(module, sender, [stream.data], "construct")
    assert _shown(reference) == _shown(events)
    single = [bytes((byte,)) for byte in stream.data]
    for cut in (data.draw(portions(stream.data)), single):
        assert _shown(codec.events_of(module, sender, cut)) == _shown(events)
    if sender.frame.told:
        return  # Nobody said what these frames are.
    is_idle = sender.frame.silence is not None
    assert not lost(sender.framing, stream, events, is_idle=is_idle), events


def _are_found_alike(module: ModuleType) -> bool:
    """True if one decoder finds the frames of all endpoints."""
    try:
        module.Decoder()
    except ValueError:
        return False
    return True


def _check_mixture(
    data: st.DataObject,
    module: ModuleType,
    name: str | None,
    senders: Sequence[Sender],
    frames: dict[str, list[bytes]],
) -> None:
    """Frames of several forms, or of several endpoints, for one decoder of them all."""
    event("frames of several forms" if name else "frames of several endpoints")
    found = [frame for sender in senders for frame in frames[sender.name]]
    if not found:
        return
    sent = data.draw(st.lists(st.sampled_from(found), min_size=1, max_size=6))
    stream = data.draw(streams(sent)).data
    most = codec.most_kept(senders)
    events = codec.events_of_several(module, name, [stream], most)
    codec.check_lossless(module, senders, stream, events)
    reference = codec.events_of_several(module, name, [stream], most, "construct")
    assert _shown(reference) == _shown(events)
    single = [bytes((byte,)) for byte in stream]
    for cut in (data.draw(portions(stream)), single):
        assert _shown(codec.events_of_several(module, name, cut, most)) == _shown(events)


def _shown(events: list[Any]) -> list[str]:
    """The events as texts, in which one NaN is like another."""
    return [repr(event) for event in events]


def _check_any_bytes(data: st.DataObject, module: ModuleType, sender: Sender) -> None:
    junk = data.draw(st.binary(max_size=50))
    events = codec.events_of(module, sender, [junk])
    codec.check_lossless(module, [sender], junk, events)
    assert _shown(codec.events_of(module, sender, [junk], "construct")) == _shown(events)
    cut = data.draw(portions(junk))
    assert _shown(codec.events_of(module, sender, cut)) == _shown(events)
    _check_exact(module, sender, junk)


@examples(EXAMPLED)
@given(schemas(), st.data())
def test_examples_that_the_reference_makes_hold(
    compile_text: Compile, schema: Schema, data: st.DataObject
) -> None:
    protocol = valid(compile_text, schema)
    sent: list[Sent] = []
    with imported(protocol) as module:
        for message in protocol.messages:
            frames_of = [sender.frame for sender in protocol.senders_of(message)]
            values = data.draw(values_of(message, frames_of))
            made = codec.check_payload(module, message, values)
            for sender in codec.senders_of(protocol, message) if made is not None else ():
                parts = data.draw(parts_of(sender.frame, message))
                frame = codec.encode(module, sender, message, made, parts)
                if frame is not None and not _keeps_rest(message):
                    shown = codec.shown_parts(sender, message, made, parts)
                    told = sender.plan.told_before(message, shown, len(frame))
                    found = _events_of_endpoint(module, sender, told, frame)
                    # Of a form above it, which wins, the bytes may be other frames.
                    if len(found) != 1 or found[0].form != sender.form:
                        continue
                    events = _events_of_endpoint(module, sender, told, frame + MORE)
                    wrong = next((item.reason for item in events if item.kind == "invalid"), "")
                    if sender.frame.told_length is not None:
                        wrong = ""  # It would be told another one for other bytes.
                    payload = made.to_payload()
                    stated = parts | held_parts(message, values)
                    sent.append(Sent(sender, message, values, stated, frame, payload, wrong))
    exampled = data.draw(with_examples(schema.data, sent))
    again = valid(compile_text, Schema(exampled, schema.shapes))
    problems = Problems()
    verify_examples(again, problems)
    assert not [f"{item.code} {item.message}" for item in problems], to_yaml(exampled)


def _keeps_rest(message: Message) -> bool:
    """True if there may be bytes of a value without a case, which examples write otherwise."""
    steps = every_step(message.plan.steps)
    return any(isinstance(step, ChooseStep) and step.rest is not None for step in steps)


def _events_of_endpoint(
    module: ModuleType, sender: Sender, told: dict[str, Any], data: bytes
) -> list[Any]:
    """The events of a decoder of all forms of an endpoint's frames."""
    decoder = module.Decoder(sender.endpoint)
    decoder.tell(**arguments(told))
    return [*decoder.feed(data), *decoder.flush()]


# --- (c) what is wrong --------------------------------------------------------------------------


@examples(EDITED)
@given(schemas(), st.data())
def test_edited_schema_has_problems_and_no_traceback(
    compile_text: Compile, schema: Schema, data: st.DataObject
) -> None:
    for _ in range(EDITS_OF_EACH):
        text = to_yaml(data.draw(edited(schema.data)))
        _check_problems(compile_text(text), text)


@examples(EDITED)
@given(schemas(), STYLES, st.data())
def test_mangled_text_has_problems_and_no_traceback(
    compile_text: Compile, schema: Schema, style: int, data: st.DataObject
) -> None:
    plain = to_styled_yaml(schema.data, style)
    for _ in range(EDITS_OF_EACH):
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
