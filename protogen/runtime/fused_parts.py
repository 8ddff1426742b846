"""What has to be known of a struct to read and write its fields together."""

from __future__ import annotations

import struct
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

Convert = Callable[[Any], Any]


@dataclass(frozen=True, slots=True)
class Step:
    """One conversion of a value: an expression of it, which is `{v}`, and of constants.

    The expression may raise anything, and `wrong`, another one, may hold: construct has to decide.
    """

    text: str = "{v}"
    wrong: str = ""
    uses: Mapping[str, Any] = field(default_factory=dict)
    """The constants by their names in the expressions."""


Steps = tuple[Step, ...]


def calling(convert: Convert) -> Steps:
    """The conversion by a function, which may raise anything where construct has to decide."""
    return (Step("{convert}({v})", uses={"convert": convert}),)


def looking_up(table: Any) -> Steps:
    """The conversion by a tuple or a dictionary of all that there is."""
    return (Step("{table}[{v}]", uses={"table": table}),)


@dataclass(frozen=True, slots=True)
class Lists:
    """Arrays of one kind of element: `size` bytes each, all of them at once."""

    size: int
    read: Convert
    """The list of the elements of so many bytes."""
    write: Convert
    """The bytes of a list or tuple. Raises where it is anything else."""


@dataclass(frozen=True, slots=True)
class Constant:
    """The only value that something can have."""

    value: Any


@dataclass(frozen=True, slots=True)
class Item:
    """A value of a fixed size: its code for `struct`, the order of its bytes, its conversions.

    `order` is empty where it does not matter. Whatever is `wrong` is asked of the value as given.
    """

    code: str
    order: str = ""
    read: Steps = ()
    write: Steps = ()
    counts: bool = False
    """Whether it is an integer."""
    constant: Constant | None = None
    """What the value has to be; it may be left out then."""
    lists: Lists | None = None
    """Arrays of it, where there is a shorter way than one element after another."""

    def ordered(self, order: str) -> Item:
        """The same among values of this order of bytes."""
        if self.order in ("", order):
            return self
        layout = struct.Struct(self.order + self.code)
        return replace(
            self,
            code=f"{layout.size}s",
            order="",
            read=(*calling(lambda data: layout.unpack(data)[0]), *self.read),
            write=(*self.write, *calling(layout.pack)),
        )


@dataclass(frozen=True, slots=True)
class Counting:
    """The earlier field that gives a number of units, and what it may give, if that is limited."""

    field: str
    least: int | None = None
    greatest: int | None = None


@dataclass(frozen=True, slots=True)
class Chunk:
    """Bytes of no fixed number: as many units as a field says, or all that are left.

    `len` of the value is its number of units.
    """

    unit: int
    """Bytes."""
    read: Steps = ()
    write: Steps = ()
    counting: Counting | None = None
    greatest: int | None = None
    """The most units that may be left."""


@dataclass(frozen=True, slots=True)
class Several:
    """A list of a few items, which go together with their neighbours."""

    count: int
    element: Item


@dataclass(frozen=True, slots=True)
class Record:
    """Fields one after another."""

    fields: tuple[tuple[str, Part], ...]


Part = Item | Several | Chunk | Record


class Unfit(Exception):  # noqa: N818 - it is no error: construct does everything then
    """The parts can't be read and written together."""


def order_of(part: Part) -> str:
    """The order of bytes that most of its values have, as `struct` writes it."""
    orders = list(_orders(part))
    return max(("<", ">"), key=orders.count)


def _orders(part: Part) -> Iterator[str]:
    if isinstance(part, Record):
        for _, inner in part.fields:
            yield from _orders(inner)
    elif isinstance(part, Several):
        yield from [part.element.order] * part.count
    elif isinstance(part, Item):
        yield part.order


def is_fixed(part: Part) -> bool:
    """Whether it has always as many bytes."""
    if isinstance(part, Record):
        return all(is_fixed(inner) for _, inner in part.fields)
    return not isinstance(part, Chunk)


Scope = tuple[Mapping[str, tuple[Part, str]], ...]
"""The fields in front, those of the innermost record first, and the text that is their value."""


def counted(scope: Scope, name: str) -> str:
    """The text of the field that counts.

    Raises Unfit where it is no integer, or is none of these: then the caller's context has it.
    """
    for fields in scope:
        if name in fields:
            part, text = fields[name]
            if isinstance(part, Item) and part.counts:
                return text
            break
    raise Unfit
