"""Values of the messages that a simulated device sends."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from itertools import cycle
from random import Random
from typing import TYPE_CHECKING, Any

from protogen.errors import UserError
from protogen.fuzzing.samples import random_samples
from protogen.link.line import LineDecoders
from protogen.passes.messages.byte_strings import with_hex_digits

if TYPE_CHECKING:
    from types import ModuleType

    from protogen.model.messages import Message
    from protogen.model.protocol import Protocol

Values = dict[str, Any]
"""Fields, or parts, by name, as lines of JSON have them."""
ValueSource = Callable[[str, float], tuple[Values, Values]]
"""Fields and parts of a message that is due, by its name and the seconds since the start."""
ValueFunction = Callable[[str, float], Mapping[str, Any]]
"""Fields of a message, by its name and the seconds since the start; others are left as they are."""


class ValuesError(UserError):
    """There are no values for a message."""


def random_values(protocol: Protocol, endpoint: str, seed: int) -> ValueSource:
    """Values in their ranges, the same for the same seed."""
    drawn: dict[str, Iterator[tuple[Values, Values]]] = {}

    def values(name: str, seconds: float) -> tuple[Values, Values]:
        if name not in drawn:
            message = protocol.message(name)
            frame = _frame(protocol, endpoint, message)
            random = Random(f"{seed} {name}")  # noqa: S311 - nothing here is secret
            drawn[name] = random_samples(message, frame, random)
        found = next(drawn[name], None)
        if found is None:
            raise ValuesError(f"no values of `{name}` fit a frame")
        return found

    return values


def example_values(protocol: Protocol, endpoint: str, seed: int) -> ValueSource:
    """Values of the schema's examples in turn; random ones where a message has none."""
    others = random_values(protocol, endpoint, seed)
    known = {
        message.name: cycle(found)
        for message in protocol.messages
        if (found := list(_examples(message)))
    }

    def values(name: str, seconds: float) -> tuple[Values, Values]:
        fields, parts = others(name, seconds)
        if name not in known:
            return fields, parts
        stated, stated_parts = next(known[name])
        return stated, parts | stated_parts

    return values


def recorded_values(
    module: ModuleType, endpoint: str, pieces: Iterable[tuple[bytes, int]], others: ValueSource
) -> ValueSource:
    """Values of a recording: those that each message had at that time, or its first ones.

    A message that the recording does not have takes those of `others`.
    """
    decoders = LineDecoders(module)
    found: dict[str, list[tuple[float, Values, Values]]] = {}
    start: int | None = None
    for data, when in pieces:
        start = when if start is None else start
        for event in decoders.feed(endpoint, data):
            if event.kind == "message":
                line = event.as_json()
                row = ((when - start) / 1e9, line["fields"], line["parts"])
                found.setdefault(line["message"], []).append(row)

    def values(name: str, seconds: float) -> tuple[Values, Values]:
        if name not in found:
            return others(name, seconds)
        rows = found[name]
        _, fields, parts = next((row for row in reversed(rows) if row[0] <= seconds), rows[0])
        return fields, parts

    return values


def computed_values(others: ValueSource, function: ValueFunction) -> ValueSource:
    """Values of a function of the time, where it gives some; `others` for the rest."""

    def values(name: str, seconds: float) -> tuple[Values, Values]:
        fields, parts = others(name, seconds)
        try:
            given: Any = function(name, seconds)
        except Exception as error:  # It is the user's own program.
            problem = f"the function of values fails for `{name}`: {type(error).__name__}: {error}"
            raise ValuesError(problem) from error
        if not isinstance(given, Mapping):
            problem = f"the function of values gives {type(given).__name__} for `{name}`"
            raise ValuesError(problem, "have it return a dict of fields; {} leaves all as they are")
        return {**fields, **given}, parts

    return values


def _examples(message: Message) -> Iterator[tuple[Values, Values]]:
    for example in message.examples:
        if example.values is not None and example.contradicts is None:
            yield with_hex_digits(message.fields, example.values), dict(example.parts)


def _frame(protocol: Protocol, endpoint: str, message: Message) -> Any:
    senders = [item for item in protocol.senders_of(message) if item.endpoint == endpoint]
    if not senders:
        raise ValuesError(f"{endpoint} does not send `{message.name}`")
    return senders[0].frame
