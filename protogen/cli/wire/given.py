"""A message as a user gives it: its name, and FIELD=VALUE and @PART=VALUE."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

import msgspec

from protogen.cli.exits import UsageError
from protogen.runtime.codec import Encoder
from protogen.runtime.errors import EncodeError

if TYPE_CHECKING:
    from protogen.cli.wire.codec import Codec
    from protogen.model.messages import Message
    from protogen.model.parts import NumberPart
    from protogen.model.protocol import Sender
    from protogen.runtime.framing.sender import SenderSpec


class GivenMessage(msgspec.Struct, frozen=True):
    """A message, who sends it in which forms of frame, and parts of its frame."""

    message: Message
    fields: Mapping[str, Any]
    specs: tuple[SenderSpec[Any, Any], ...]
    record: Any
    """The message as encoders take it."""
    parts: Mapping[str, Any]
    """Arguments of encoders."""

    def frame(self) -> bytes:
        """The frame, with each counter that is not given at its least. Raises UsageError."""
        with self.explained():
            return Encoder(self.specs).encode_next(self.record, strict=True, **self.parts)

    @contextmanager
    def explained(self) -> Iterator[None]:
        """Turn an error of an encoder into a UsageError that says what may be given."""
        try:
            yield
        except EncodeError as error:
            raise _usage_error(self.message, self.fields, error) from None


def _usage_error(message: Message, fields: Mapping[str, Any], error: EncodeError) -> UsageError:
    from protogen.cli.wire.hints import hint_at

    return UsageError(str(error), hint_at(message.plan.steps, fields, error.path))


def given_message(
    codec: Codec, name: str, written: Iterable[str], sender: str | None, form: str | None
) -> GivenMessage:
    """Read a message. Raises UsageError, with a hint of what may be given."""
    from protogen.cli.schemas import find_message
    from protogen.cli.wire.values import raw_values, split_assignment, tree_of
    from protogen.model.messages import given_parts
    from protogen.runtime.attributes import arguments

    message = find_message(codec.protocol, name)
    forms = _forms_of(codec, message, sender, form)
    given = [split_assignment(text) for text in written]
    fields = raw_values(message.plan.steps, tree_of(item for item in given if item[0][0] != "@"))
    parts = _parts([part for item in forms for part in given_parts(item.frame, message)], given)
    specs = tuple(codec.runtime.sender(item.name) for item in forms)
    kind = specs[0].named(name)
    assert kind is not None
    try:
        record = kind.from_dict(fields)
    except EncodeError as error:
        raise _usage_error(message, fields, error) from None
    return GivenMessage(message, fields, specs, record, arguments(parts))


def _forms_of(codec: Codec, message: Message, name: str | None, form: str | None) -> list[Sender]:
    """Return who sends the message, in each form of frame that is asked for and carries it."""
    from protogen.cli.schemas import check_known, find_senders

    found = codec.protocol.senders_of(message)
    if name is not None:
        found = tuple(item for item in find_senders(codec.protocol, name) if item.sends(message))
    if not found:
        raise UsageError(f"{name} does not send `{message.name}`; {_all_of(message.senders)} does")
    forms: dict[str, list[Sender]] = {}
    for item in found:
        forms.setdefault(item.endpoint, []).append(item)
    frames = [[item.frame for item in own] for own in forms.values()]
    if any(own != frames[0] for own in frames):
        text = f"`{message.name}` has several senders, and their frames differ"
        raise UsageError(text, f"give --sender {_all_of(forms)}")
    own = next(iter(forms.values()))
    if form is not None:
        known = [item.form for item in own if not item.is_only_form]
        check_known("form of frame", [form], known, codec.protocol.name)
    return [item for item in own if form in (None, item.form)]


def _all_of(names: Iterable[str]) -> str:
    return " or ".join(names)


def _parts(known: Iterable[NumberPart], given: Iterable[tuple[str, str]]) -> dict[str, int | str]:
    from protogen.cli.wire.scalars import text_value
    from protogen.problems import hint_for

    texts = {part.name: part.type.is_text for part in known}
    names = list(texts)
    parts: dict[str, int | str] = {}
    for written, text in given:
        name = written.removeprefix("@")
        if name == written:
            continue
        if name not in names:
            hint = hint_for(name, names) or f"there are {', '.join(names) or 'none'}"
            raise UsageError(f"there is no part `{name}` to give", hint)
        parts[name] = text_value(text, written) if texts[name] else _number(name, text)
    return parts


def _number(name: str, text: str) -> int:
    try:
        return int(text, 0)
    except ValueError:
        raise UsageError(f"@{name}: `{text}` is no number") from None
