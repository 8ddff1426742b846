"""Round trips of samples through a codec: does everything come back as it went in?"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from random import Random
from typing import Any

import msgspec

from protogen.copying import replace
from protogen.fuzzing.engine import Engine, Refused, Seen
from protogen.fuzzing.samples import Values, boundary_rounds, samples, samples_at_least
from protogen.model.messages import Message
from protogen.model.protocol import Protocol, Sender


class Case(msgspec.Struct, frozen=True):
    """One sample of one message."""

    sender: str
    message: str
    values: Values
    parts: Values


class Outcome(msgspec.Struct, frozen=True):
    """Outcome of a case: fine where there is neither a problem nor a refusal."""

    case: Case
    problem: str = ""
    """Description of what did not come back as it went in."""
    refused: str = ""
    """Reason of an encoder that did not send it, where it may refuse."""
    frame: bytes = b""


def cases(protocol: Protocol, count: int, seed: int, only: str | None = None) -> Iterator[Case]:
    """Yield cases for every sender and message: all boundaries, and `count` of them at least.

    A seed always gives the same cases for a message, whatever others are asked for.
    """
    for sender, message in _messages(protocol, only):
        random = Random(f"{seed} {sender.name} {message.name}")  # noqa: S311 - nothing secret
        for values, parts in samples_at_least(count, message, sender.frame, random):
            yield Case(sender.name, message.name, values, parts)


def case_count(protocol: Protocol, count: int, only: str | None = None) -> int:
    """Number of cases."""
    return sum(
        max(count, boundary_rounds(message, sender.frame))
        for sender, message in _messages(protocol, only)
    )


def _messages(protocol: Protocol, only: str | None) -> Iterator[tuple[Sender, Message]]:
    for sender in protocol.senders:
        for message in sender.messages:
            if only in (None, message.name):
                yield sender, message


def try_engines(engines: Sequence[Engine], protocol: Protocol, case: Case) -> list[Outcome]:
    """Take one case through each engine; the others have to make the frame of the first."""
    first, *others = engines
    expected = _try_alone(first, protocol, case)
    outcomes = (_try_alone(engine, protocol, case) for engine in others)
    return [expected, *(_compared(outcome, expected, first) for outcome in outcomes)]


def try_case(
    engine: Engine, protocol: Protocol, case: Case, reference: Engine | None = None
) -> Outcome:
    """Take one case through an engine, there and back; a reference has to make the same frame."""
    if reference is None:
        return _try_alone(engine, protocol, case)
    return try_engines([reference, engine], protocol, case)[1]


def _compared(outcome: Outcome, expected: Outcome, reference: Engine) -> Outcome:
    if outcome.problem or outcome.frame == expected.frame:
        return outcome
    made = f"makes {expected.frame.hex()}" if expected.frame else f"refuses: {expected.refused}"
    return replace(outcome, problem=f"another engine, {reference.name}, {made}")


def _try_alone(engine: Engine, protocol: Protocol, case: Case) -> Outcome:
    try:
        return _trip(engine, protocol.sender(case.sender), case)
    except Refused as error:
        return Outcome(case, problem=f"refused: {error}")
    except Exception as error:
        return Outcome(case, problem=f"raised {type(error).__name__}: {error}")


def _trip(engine: Engine, sender: Sender, case: Case) -> Outcome:
    payload = engine.payload(case.message, case.values)
    message = next(item for item in sender.messages if item.name == case.message)
    held = {field.name: case.values[field.name] for field in message.held}
    back = engine.values(case.message, payload, held)
    if not same(back, case.values):
        return Outcome(case, problem=f"the payload {payload.hex()} gives other values: {back}")
    try:
        frame = engine.frame(case.sender, case.message, case.values, case.parts)
    except Refused as error:
        if sender.framing.cut_ambiguous or sender.framing.is_cut_off:
            return Outcome(case, refused=str(error))
        raise
    problem = _wrong_with_events(engine, sender, case, payload, frame)
    return Outcome(case, problem=problem, frame=frame)


def told_of(sender: Sender, case: Case, frame: bytes) -> dict[str, int]:
    """What the receiver of a case has to be told before its frame."""
    message = next(item for item in sender.messages if item.name == case.message)
    return sender.plan.told_before(message, case.parts, len(frame))


def _wrong_with_events(
    engine: Engine, sender: Sender, case: Case, payload: bytes, frame: bytes
) -> str:
    told = told_of(sender, case, frame)
    events = engine.events(case.sender, [frame], told)
    single = engine.events(case.sender, [bytes((byte,)) for byte in frame], told)
    if not same_events(events, single):
        return f"byte by byte it decodes to {single}, at once to {events}"
    if len(events) != 1 or events[0].kind != "message" or events[0].size != len(frame):
        return f"the frame decodes to {events}"
    event = events[0]
    if event.payload != payload:
        return f"the frame carries another payload: {event.payload.hex()}"
    if event.message != sender.received_as(case.message):
        return f"the frame decodes to the message {event.message}"
    if event.message == case.message and not same(event.values, case.values):
        return f"the frame decodes to other values: {event.values}"
    found = {name: (event.parts or {}).get(name) for name in case.parts}
    return "" if found == case.parts else f"the frame decodes to other parts: {found}"


def same_events(left: Sequence[Seen], right: Sequence[Seen]) -> bool:
    """True if two lists of events are equal."""
    return len(left) == len(right) and all(
        replace(one, values=None) == replace(other, values=None) and same(one.values, other.values)
        for one, other in zip(left, right, strict=True)
    )


def same(left: Any, right: Any) -> bool:
    """True if values are equal; 0.0 and -0.0 are not, and `true` is 1."""
    if isinstance(left, dict) and isinstance(right, dict):
        return left.keys() == right.keys() and all(same(left[key], right[key]) for key in left)
    if isinstance(left, list) and isinstance(right, list):
        return len(left) == len(right) and all(map(same, left, right))
    if isinstance(left, float) and isinstance(right, float) and left == right == 0:
        return math.copysign(1, left) == math.copysign(1, right)
    return bool(left == right)


def smallest(
    engine: Engine, protocol: Protocol, outcome: Outcome, reference: Engine | None = None
) -> Outcome:
    """Replace values by plain ones as long as the case fails in the same way."""
    message = protocol.message(outcome.case.message)
    frame = protocol.sender(outcome.case.sender).frame
    plain_values, plain_parts = next(samples(message, frame, Random(0)))  # noqa: S311
    for name, value in plain_values.items():
        case = replace(outcome.case, values={**outcome.case.values, name: value})
        outcome = _if_alike(try_case(engine, protocol, case, reference), outcome)
    for name, value in plain_parts.items():
        case = replace(outcome.case, parts={**outcome.case.parts, name: value})
        outcome = _if_alike(try_case(engine, protocol, case, reference), outcome)
    return outcome


def _if_alike(new: Outcome, old: Outcome) -> Outcome:
    """The new outcome if it is the same kind of failure: its text begins in the same way."""
    return new if new.problem.split(" ")[:3] == old.problem.split(" ")[:3] else old
