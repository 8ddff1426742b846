"""Fields behind all that an old version knows: where they hurt nobody."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator

from protogen.copying import replace
from protogen.evolution.change import Change
from protogen.model.extents import Fixed
from protogen.model.frame_plan import FramePlan
from protogen.model.messages import Message
from protogen.model.presence import Trailing
from protogen.model.types import Array, Field, NumberType, Octets, Struct, Text, Type


def with_appended(
    changes: Iterable[Change],
    message: Message,
    other: Message,
    plans: Collection[tuple[FramePlan, FramePlan]],
) -> Iterator[Change]:
    """The changes of a message; fields that were appended have a rule of their own.

    `plans` are the frames of OLD and NEW that carry it. Old receivers leave what is behind the
    fields that they know; new ones take it for zeros, or for fields, that were left out.
    """
    behind = other.fields[len(message.fields) :]
    is_cut = bool(plans) and all(_is_cut(old, message, other) for old, _ in plans)
    is_filled_up = (
        is_cut and other.sizes.fixed is not None and all(new.is_trimmed for _, new in plans)
    )
    names = {field.name for field in behind if is_cut and _is_trailing(field)}
    names |= {field.name for field in behind if is_filled_up and _may_be_zeros(field)}
    for change in changes:
        is_appended = change.rule == "field-added" and change.path in names
        yield replace(change, rule="field-appended") if is_appended else change


def _is_cut(old: FramePlan, message: Message, other: Message) -> bool:
    """True if old receivers leave what new payloads have more."""
    longest = old.frame.payload.longest
    if longest is None or not message.can_be_cut:
        return False
    return (message.cut_size or 0) <= other.sizes.greatest <= longest


def _is_trailing(field: Field) -> bool:
    return isinstance(field.presence, Trailing)


def _may_be_zeros(field: Field) -> bool:
    """True if a receiver takes zeros for the field."""
    is_plain = field.const is None and field.presence is None and field.region is None
    return is_plain and _takes_zeros(field.type)


def _takes_zeros(type_: Type) -> bool:
    if isinstance(type_, NumberType):
        named = () if type_.enum is None else [item.value for item in type_.enum.values]
        return type_.text is None and (not type_.is_closed or 0 in named)
    match type_:
        case Text():
            return isinstance(type_.extent, Fixed) and 0 in type_.form.alphabet
        case Octets():
            return isinstance(type_.extent, Fixed)
        case Array():
            return isinstance(type_.extent, Fixed) and _takes_zeros(type_.element)
        case Struct():
            return all(map(_may_be_zeros, type_.fields))
        case _:
            return False
