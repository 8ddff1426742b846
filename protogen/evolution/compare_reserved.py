"""Changes of what is reserved: entries that go, and what is used though it was reserved."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import NamedTuple

from protogen.evolution.change import Change
from protogen.model.identities import Identities
from protogen.model.meanings import Enum
from protogen.model.messages import Message
from protogen.model.nesting import fields_inside
from protogen.model.protocol import Protocol
from protogen.model.types import Field, Type


class _Entry(NamedTuple):
    """One thing that is reserved, in the names of NEW: an identity, a field or a value."""

    place: str
    what: object
    words: str


def compare_reserved(
    old: Protocol, new: Protocol, endpoints: Mapping[str, str], messages: Mapping[str, str]
) -> Iterator[Change]:
    """Yield the entries of OLD that NEW has no more; whether it uses them is told apart.

    What was reserved inside of a message or type that is gone goes with it.
    """
    there = {place for place, _ in _used(new)} | {sender.name for sender in new.senders}
    kept = {(entry.place, entry.what) for entry in _entries(new, {}, {})}
    used = _used(new)
    for entry in _entries(old, endpoints, messages):
        user = _user_of(used, entry)
        if user:
            words = f"{entry.words} is {user}"
            yield Change(rule="reserved-reused", place=f"reserved {entry.place}", text=words)
        elif not _is_kept(kept, entry) and entry.place in there:
            yield Change(rule="reserved-deleted", place=f"reserved {entry.place}", text=entry.words)


def _user_of(used: Mapping[tuple[str, object], str], entry: _Entry) -> str | None:
    """Name of what uses the thing that was reserved."""
    if not isinstance(entry.what, Identities):
        return used.get((entry.place, entry.what))
    return next(
        (
            name
            for (place, what), name in used.items()
            if place == entry.place
            and isinstance(what, Identities)
            and what.meet(entry.what) is not None
        ),
        None,
    )


def _is_kept(kept: Iterable[tuple[str, object]], entry: _Entry) -> bool:
    """True if the thing is still reserved."""
    if not isinstance(entry.what, Identities):
        return (entry.place, entry.what) in kept
    own = [what for place, what in kept if place == entry.place and isinstance(what, Identities)]
    return all(any(item.covers(run) for item in own) for run in entry.what.each_run())


def _entries(
    protocol: Protocol, endpoints: Mapping[str, str], messages: Mapping[str, str]
) -> Iterator[_Entry]:
    reserved = protocol.reserved
    for item in reserved.identities:
        place = endpoints.get(item.sender, item.sender)
        shown = item.told_by.shown(protocol.forms(item.sender)[0].frame.identity)
        yield _Entry(place, item.told_by, f"identity {shown} of {item.sender}")
    for names in reserved.fields:
        place = messages.get(names.message, names.message)
        for name in names.names:
            yield _Entry(place, name, f"the name {name} in {names.message}")
    for values in reserved.values:
        message, dot, rest = values.path.partition(".")
        place = f"{messages.get(message, message)}{dot}{rest}" if dot else message
        for value in values.values:
            yield _Entry(place, value, f"value {value} of {values.path}")


def _used(protocol: Protocol) -> dict[tuple[str, object], str]:
    """Identities, fields and values in use, with what uses them."""
    used: dict[tuple[str, object], str] = {}
    for message in protocol.messages:
        for sender in message.senders:
            used[sender, message.told_by] = message.name
        for path, field in _fields(message):
            used[message.name, path] = f"a field of {message.name}"
            used |= _values(f"{message.name}.{path}", field.type)
    for enum in protocol.enums:
        used |= {(enum.name, item.value): item.name for item in enum.values}
    return used


def _fields(message: Message) -> Iterator[tuple[str, Field]]:
    open_: list[tuple[str, Field]] = [(field.name, field) for field in message.fields]
    while open_:
        path, field = open_.pop()
        yield path, field
        open_ += [(f"{path}.{inner.name}", inner) for inner in fields_inside(field.type)]


def _values(path: str, type_: Type) -> dict[tuple[str, object], str]:
    enum: Enum | None = getattr(type_, "enum", None)
    return {} if enum is None else {(path, item.value): item.name for item in enum.values}
