"""Fields that are parts of the frame: each is a number of all frames that carry the message."""

from __future__ import annotations

from protogen.model.frame import Frame
from protogen.model.messages import Message, given_parts
from protogen.model.parts import CounterPart, NumberPart
from protogen.model.types import Field, is_integer, total
from protogen.passes.context import Context, Loc
from protogen.passes.draft import Draft
from protogen.passes.framing.capacity import is_delimited
from protogen.problems import hint_for


def check_part_fields(context: Context, draft: Draft) -> None:
    """Check that a field which is a part is a number that senders choose in each frame."""
    for message in draft.messages.values():
        for field in message.held:
            loc: Loc = ("messages", message.name, "fields", field.name, "part")
            for sender, frame in draft.frames.items():
                if message.name in draft.carried[sender] and not _fits(
                    context, message, field, frame, loc
                ):
                    break


def _fits(context: Context, message: Message, field: Field, frame: Frame, loc: Loc) -> bool:
    """True if the field is a part of this frame; else that was reported."""
    given = {part.name: part for part in given_parts(frame, message)}
    part = given.get(field.part)
    if part is None or isinstance(part, CounterPart):
        text = f"`{field.part}` is {_otherwise(frame, field.part)}"
        known = [name for name, item in given.items() if _can_be_field(item)]
        hint = hint_for(field.part, known) or _advice(known)
        context.error("PG290", loc, text, hint)
        return False
    return _has_type(context, field, part, loc) and _comes_in_time(
        context, message, frame, part, loc
    )


def _can_be_field(part: NumberPart) -> bool:
    return not isinstance(part, CounterPart) and not part.type.is_text


def _otherwise(frame: Frame, name: str) -> str:
    """What a part is that no sender chooses."""
    if any(part.name == name for part in frame.identity):
        return "the same in each frame of the message, as this has one identity"
    if any(part.name == name and isinstance(part, CounterPart) for part in frame.numbers):
        return "a counter, which the encoder advances"
    if any(part.name == name for part in (*frame.parts, *frame.numbers)):
        return "no number that the sender chooses"
    return "no part of a frame that carries the message"


def _advice(known: list[str]) -> str:
    if not known:
        return "give the frame a part with a `type` and no other key"
    return f"name one of: {', '.join(known)}"


def _has_type(context: Context, field: Field, part: NumberPart, loc: Loc) -> bool:
    type_ = field.type
    assert is_integer(type_)
    if part.type.is_text:
        text = f"`{part.name}` is a text, and a field that is a part is a number"
        context.error("PG290", loc, text, "give the part a type such as `uint8`")
        return False
    if type_.bits != part.type.bits or type_.signed:
        text = f"`{part.name}` is an unsigned integer of {part.type.bits} bits"
        hint = f"`{field.name}` has the same: `type: uint{part.type.bits}`"
        context.error("PG290", (*loc[:-1], "type"), text, hint)
        return False
    return True


def _comes_in_time(
    context: Context, message: Message, frame: Frame, part: NumberPart, loc: Loc
) -> bool:
    """True unless the fields tell by the part where they end, and it stands behind them."""
    if (
        is_delimited(frame)
        or total(message.fields).fixed is not None
        or frame.is_known_early(part.name)
    ):
        return True
    text = f"the fields tell where they end, and `{part.name}` stands behind them"
    hint = "move the part in front of the payload, or give the frame a length or an end"
    context.error("PG292", loc, text, hint)
    return False
