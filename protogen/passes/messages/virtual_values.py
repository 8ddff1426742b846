"""Values of virtual parts: what each message puts into checksums and does not send."""

from __future__ import annotations

from collections.abc import Mapping

from protogen.model.frame import Frame
from protogen.model.identities import Identities
from protogen.model.messages import Message
from protogen.model.parts import NumberPart, VirtualPart
from protogen.passes.context import Context, Loc
from protogen.passes.draft import Draft
from protogen.passes.framing.part_values import number_of
from protogen.problems import did_you_mean, hint_for
from protogen.schema.syntax.messages import MessageSyntax

_Values = tuple[tuple[str, int], ...]


def virtual_values(
    context: Context, name: str, syntax: MessageSyntax, frames: Mapping[str, Frame]
) -> _Values:
    """The values that a message gives to virtual parts of its `frames`, by their senders.

    A value that is the default anyway is none that counts.
    """
    loc: Loc = ("messages", name)
    parts: dict[str, dict[str, VirtualPart]] = {}
    for sender, frame in frames.items():
        for part in frame.virtual:
            parts.setdefault(part.name, {})[sender] = part
    written = syntax.parts or {}
    given: dict[str, int] = {}
    meant: set[str | None] = set()
    for key, value in written.items():
        if key not in parts:
            _report_unknown(context, (*loc, "parts", key), key, frames, list(parts))
            meant.add(did_you_mean(key, parts))
            continue
        number = _number(context, (*loc, "parts", key), parts[key], value)
        if number is not None:
            given[key] = number
    for key, by_sender in parts.items():
        lacking = [sender for sender, part in by_sender.items() if part.default is None]
        if key not in written and key not in meant and lacking:
            text = f"`{name}` gives `{key}` no value, which goes into the checksum of its frames"
            hint = f"add `parts: {{{key}: VALUE}}`, or give the part a `default`"
            context.error_at_key("PG232", loc, text, hint)
    return tuple(
        (key, number)
        for key, number in given.items()
        if any(part.default != number for part in parts[key].values())
    )


def _number(
    context: Context, loc: Loc, parts: Mapping[str, VirtualPart], value: int | str
) -> int | None:
    """The number that is meant, in each of the frames; None where one of them can't hold it."""
    found: int | None = None
    for part in parts.values():
        type_ = part.type
        as_number = NumberPart(
            name=part.name, type=type_, least=type_.least, greatest=type_.greatest
        )
        found = number_of(context, loc, as_number, value)
        if found is None:
            return None
        if not as_number.holds(found):
            context.error("PG114", loc, f"{part.shown(found)} is out of {as_number.allowed}")
            return None
    return found


def _report_unknown(
    context: Context, loc: Loc, name: str, frames: Mapping[str, Frame], known: list[str]
) -> None:
    sent = any(part.name == name for frame in frames.values() for part in frame.numbers)
    if sent:
        text = f"`{name}` is sent in each frame, so that a message does not give its value"
        hint = "messages give values of parts with `virtual: true`"
        context.error_at_key("PG233", loc, text, hint)
        return
    text = f"no frame of this message has a virtual part called `{name}`"
    context.error_at_key("PG233", loc, text, hint_for(name, known))


def check_shared_values(context: Context, draft: Draft) -> None:
    """Check that the identity of a frame tells what goes into its checksum."""
    reported: set[str] = set()
    for sender, frame in draft.frames.items():
        seen: dict[Identities, Message] = {}
        for message in draft.sent_by(sender) if frame.virtual else ():
            first = seen.setdefault(message.told_by, message)
            for part in frame.virtual:
                one, other = first.virtual_value(part), message.virtual_value(part)
                if one == other or None in (one, other) or message.name in reported:
                    continue
                reported.add(message.name)
                text = f"`{message.name}` and `{first.name}` have one identity, and `{part.name}`"
                text = f"{text} is {other} in one and {one} in the other"
                hint = "a receiver knows the value by the identity: give both the same"
                context.error_at_key("PG233", ("messages", message.name), text, hint)
