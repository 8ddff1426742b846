"""Every field of a message, also those inside structs, arrays and switches."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from protogen.model.messages import Message
from protogen.model.types import Array, Field, Integer, Struct, Switch, Type
from protogen.targets.markdown.path import ROOT, Path
from protogen.targets.markdown.types import integer_of


def named_fields(fields: Iterable[Field], path: Path = ROOT) -> Iterator[tuple[Path, Field]]:
    """Yield each field with its path, such as `points[i].range`, in wire order."""
    for field in fields:
        inner = path.field(field.name)
        yield inner, field
        yield from _inside(field.type, inner)


def _inside(kind: Type, path: Path) -> Iterator[tuple[Path, Field]]:
    match kind:
        case Struct():
            yield from named_fields(kind.fields, path)
        case Array():
            yield from _inside(kind.element, path.element())
        case Switch():
            for case in kind.cases:
                yield from _inside(case.type, path.case(case.name))


def type_users(messages: Iterable[Message]) -> dict[str, list[Integer]]:
    """Return, for each enum and flags by name, the integers of the fields that use it."""
    users: dict[str, list[Integer]] = {}
    for message in messages:
        for _, field in named_fields(message.fields):
            integer = integer_of(field.type)
            named = integer and (integer.enum or integer.flags)
            if integer and named:
                users.setdefault(named.name, []).append(integer)
    return users
