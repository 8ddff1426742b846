"""A lock file: resolved protocols with their hashes, to compare with where there is no git.

It holds all that bytes and their meaning depend on, one line for each value, so that a review shows
what changed. Texts for people, examples and decisions are left out.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from fractions import Fraction
from functools import cache
from pathlib import Path
from typing import Any

from msgspec import NODEFAULT

from protogen.copying import defaults_of, is_record, replace
from protogen.model import (
    checksums,
    expressions,
    frame,
    framing,
    identities,
    meanings,
    messages,
    numbers,
    origin,
    parts,
    protocol,
    sizes,
    transparency,
)
from protogen.model import types as model_types
from protogen.model.messages import Message
from protogen.model.protocol import Protocol, Sender
from protogen.passes.framing.frame_plan import plan_frame
from protogen.passes.spec_hash import CALLED
from protogen.problems.span import Span
from protogen.version import VERSION

NAME = "protogen.lock"
"""The file's usual name."""
_FORM = 1
_NOWHERE = Span("", 1, 1, 1, 1)
_LEFT_OUT: Mapping[str, Any] = {
    "about": origin.NOTHING,
    "span": _NOWHERE,
    "source": None,
    "summary": "",
    "doc": "",
    "examples": (),
    "exchanges": (),
    "decisions": (),
    "plan": None,
    "renamed_from": None,
    "rate": None,
    "at": 0,
}
"""Keys of text for readers and of derived facts, with what stands for them in a lock."""
_MODULES = (
    checksums,
    expressions,
    frame,
    framing,
    identities,
    meanings,
    messages,
    model_types,
    numbers,
    origin,
    parts,
    protocol,
    sizes,
    transparency,
)


_NOW = {before: name for name, before in CALLED.items()}
"""Names of members that were called otherwise."""
_NAMES = frozenset({"by", "mark", "selector", "when", "left", "right", "operand"})
"""Members that are expressions."""


class LockError(Exception):
    """A lock that can't be read; the message says why."""


def lock_text(protocols: Mapping[str, Protocol]) -> str:
    """The lock of protocols, by the paths of their schemas."""
    schemas = {path: _entry(item) for path, item in sorted(protocols.items())}
    whole = {"form": _FORM, "protogen": VERSION, "schemas": schemas}
    return json.dumps(whole, indent=1, ensure_ascii=False) + "\n"


def read_lock(path: Path) -> dict[str, Protocol]:
    """The protocols of a lock, by the paths of their schemas. Raises LockError."""
    try:
        whole = json.loads(path.read_text(encoding="utf-8"))
        form = whole["form"]
    except (OSError, ValueError, KeyError, TypeError) as error:
        message = f"`{path}` is no lock of protogen: {error}"
        raise LockError(message) from None
    if form != _FORM:
        message = f"`{path}` has the form {form}, this protogen reads {_FORM}; lock again"
        raise LockError(message)
    try:
        return {name: _restored(entry["model"]) for name, entry in whole["schemas"].items()}
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        message = f"`{path}` was changed by hand, or is damaged: {error!r}"
        raise LockError(message) from None


def _entry(item: Protocol) -> dict[str, Any]:
    return {
        "spec_hash": item.spec_hash,
        "messages": {message.name: message.spec_hash for message in item.messages},
        "model": _plain(item),
    }


# --- to JSON and back -----------------------------------------------------------------------------


def _plain(value: Any) -> Any:
    match value:
        case None | bool() | int() | float() | str():
            return value
        case Fraction():
            return {"fraction": str(value)}
        case bytes():
            return {"hex": value.hex()}
        case tuple() | list():
            return [_plain(item) for item in value]
        case Mapping():
            return {"map": {key: _plain(item) for key, item in value.items()}}
        case expressions.Operand() if expressions.plain_name(value):
            return str(value)
    found: dict[str, Any] = {"class": type(value).__name__}
    kind: Any = type(value)
    for name, default in _kept(kind):
        item = getattr(value, name)
        if default is NODEFAULT or item != default:
            found[CALLED.get(name, name)] = _plain(item)
    if isinstance(value, Sender):  # The protocol holds its messages.
        found["messages"] = [message.name for message in value.messages]
    return found


@cache
def _kept(kind: Any) -> tuple[tuple[str, Any], ...]:
    """The names of what a lock keeps of an object, and their defaults."""
    return tuple(item for item in defaults_of(kind).items() if item[0] not in _LEFT_OUT)


def _restored(value: Any) -> Any:
    if isinstance(value, list):
        return tuple(_restored(item) for item in value)
    if not isinstance(value, dict):
        return value
    if value.keys() == {"fraction"}:
        return Fraction(value["fraction"])
    if value.keys() == {"hex"}:
        return bytes.fromhex(value["hex"])
    if value.keys() == {"map"}:
        return {key: _restored(item) for key, item in value["map"].items()}
    kind = _kinds()[value["class"]]
    names = defaults_of(kind)
    given: dict[str, Any] = {}
    for written, item in value.items():
        name = str(written if written in names else _NOW.get(written, written))
        given[name] = _restored_name(item) if name in _NAMES else _restored(item)
    given.pop("class")
    found = kind(**{name: item for name, item in _LEFT_OUT.items() if name in names}, **given)
    return _with_messages(found) if isinstance(found, Protocol) else found


def _restored_name(value: Any) -> Any:
    """What counts or selects: in most cases it is no more than the name of a field."""
    return expressions.named(value) if isinstance(value, str) else _restored(value)


def _with_messages(item: Protocol) -> Protocol:
    """The protocol whose senders hold the messages that they name."""
    known: dict[Any, Message] = {message.name: message for message in item.messages}
    senders = tuple(_with_plan(sender, known) for sender in item.senders)
    return replace(item, senders=senders)


def _with_plan(sender: Sender, known: Mapping[Any, Message]) -> Sender:
    messages = tuple(known[name] for name in sender.messages)
    plan = plan_frame(sender.frame, sender.framing, messages, sender.overloads)
    return replace(sender, messages=messages, plan=plan)


@cache
def _kinds() -> dict[str, Any]:
    return dict(_classes())


def _classes() -> Iterator[tuple[str, Any]]:
    for module in _MODULES:
        for name, item in vars(module).items():
            if isinstance(item, type) and is_record(item):
                yield name, item
