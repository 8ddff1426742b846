"""The payload of an example, cut into fields, each with its value and meaning."""

from __future__ import annotations

import struct
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass

from protogen.model.fields import Field
from protogen.model.types import (
    Array,
    Counted,
    Extent,
    Fill,
    Float,
    Integer,
    Octets,
    Struct,
    Switch,
    Text,
    Type,
)
from protogen.runtime.errors import ByteError
from protogen.runtime.number import Number
from protogen.targets.escape import markdown
from protogen.targets.markdown.unstuff import Unit
from protogen.targets.markdown.values import raw_text, value_meaning
from protogen.targets.markdown.words import code

_MOST_VALUES = 8
"""Values of one row that are printed."""
_MOST_ELEMENTS = 32
"""Elements of an array of structs that get rows of their own."""

Scope = Mapping[str, int]
"""The integers read so far that a count or a switch can name."""


@dataclass(frozen=True, slots=True)
class Cut:
    """A run of bytes that is one thing."""

    units: Sequence[Unit]
    name: str
    value: str = ""
    meaning: str = ""

    @property
    def data(self) -> bytes:
        """The bytes without transparency."""
        return bytes(unit.byte for unit in self.units)

    @property
    def wire(self) -> bytes:
        """The bytes as they are sent."""
        return b"".join(unit.wire for unit in self.units)


class _Reader:
    """Hands out units from the front."""

    def __init__(self, units: Sequence[Unit]) -> None:
        self._units = units
        self._next = 0

    @property
    def left(self) -> int:
        """How many units are left."""
        return len(self._units) - self._next

    def take(self, size: int) -> Sequence[Unit]:
        """Return the next units. Raises EOFError if there are not so many."""
        if size > self.left:
            raise EOFError
        taken = self._units[self._next : self._next + size]
        self._next += size
        return taken


def payload_cuts(fields: Sequence[Field], units: Sequence[Unit]) -> Iterator[Cut]:
    """Cut a payload into fields; what does not fit the fields becomes the last cut."""
    done = 0
    with suppress(EOFError, ByteError):
        for cut in _struct_cuts(fields, _Reader(units), "", {}):
            done += len(cut.units)
            yield cut
    if done < len(units):
        yield Cut(units[done:], "", "", "Does not fit the message.")


def _struct_cuts(
    fields: Sequence[Field], reader: _Reader, path: str, scope: Scope
) -> Iterator[Cut]:
    known = dict(scope)
    for field in fields:
        name = f"{path}{field.name}"
        if isinstance(field.type, Integer):
            units = reader.take(field.type.size)
            cut = Cut(units, code(name))
            known[field.name] = integer_of_bytes(field.type, cut.data)
            yield _number_cut(cut, known[field.name], field, field.type)
        else:
            yield from _cuts(field.type, reader, name, known, field)


def _cuts(kind: Type, reader: _Reader, name: str, scope: Scope, field: Field) -> Iterator[Cut]:
    match kind:
        case Struct():
            yield from _struct_cuts(kind.fields, reader, f"{name}.", scope)
        case Switch():
            yield from _case_cuts(kind, reader, name, scope, field)
        case Array():
            yield from _array_cuts(kind, reader, name, scope, field)
        case Text() | Octets():
            units = reader.take(_count(kind.extent, scope, reader.left, 1))
            yield _bytes_cut(Cut(units, code(name)), kind, field)
        case Integer() | Float():
            yield _scalar_cut(kind, Cut(reader.take(kind.size), code(name)), field)


def _case_cuts(
    switch: Switch, reader: _Reader, name: str, scope: Scope, field: Field
) -> Iterator[Cut]:
    chosen = [case for case in switch.cases if case.value == scope[switch.selector]]
    if chosen:
        yield from _cuts(chosen[0].type, reader, name, scope, field)
    elif switch.rest is not None:
        yield Cut(reader.take(reader.left), code(name), "", "Raw bytes, as no case has this value.")


def _array_cuts(
    array: Array, reader: _Reader, name: str, scope: Scope, field: Field
) -> Iterator[Cut]:
    element = array.element
    count = _count(array.extent, scope, reader.left, element.sizes.least)
    if isinstance(element, Integer | Float):
        yield _list_cut(Cut(reader.take(count * element.size), code(name)), element, field)
    elif count <= _MOST_ELEMENTS:
        for index in range(count):
            yield from _element_cuts(element, reader, f"{name}[{index}]", scope, field)
    else:
        size = element.sizes.fixed
        units = reader.take(reader.left if size is None else count * size)
        yield Cut(units, code(name), "", f"{count} elements.")


def _element_cuts(
    element: Type, reader: _Reader, name: str, scope: Scope, field: Field
) -> Iterator[Cut]:
    """Cut one element of an array; a struct of numbers becomes one row."""
    cuts = [*_cuts(element, reader, name, scope, field)]
    if not isinstance(element, Struct) or not all(map(_is_number, element.fields)):
        yield from cuts
        return
    units = [unit for cut in cuts for unit in cut.units]
    pairs = zip(element.fields, cuts, strict=True)
    values = (f"{item.name} {cut.value}{_named(cut, item)}" for item, cut in pairs)
    yield Cut(units, code(name), ", ".join(values))


def _is_number(field: Field) -> bool:
    return isinstance(field.type, Integer | Float)


def _named(cut: Cut, field: Field) -> str:
    """Return what a number means in brackets, unless that is only what its field is."""
    meaning = "" if cut.meaning == markdown(field.about.doc) else cut.meaning
    return f" ({meaning})" if meaning else ""


def _count(extent: Extent, scope: Scope, left: int, size: int) -> int:
    """Return how many elements there are; `left` bytes remain, and each takes `size`."""
    match extent:
        case Fill():
            return left // max(size, 1)
        case Counted(field=name):
            return scope[name]
        case _:
            return extent.count


def integer_of_bytes(kind: Integer, data: bytes) -> int:
    """Read an integer. Raises ByteError if bits above its own are set."""
    return Number(kind.bits, kind.signed, kind.byte_order, kind.byte_bits == 7).decode(data)


def _float(kind: Float, data: bytes) -> float:
    raw = Number(kind.bits, False, kind.byte_order, kind.byte_bits == 7).decode(data)
    size = kind.bits // 8
    value: float = struct.unpack(">f" if size == 4 else ">d", raw.to_bytes(size, "big"))[0]
    return value


def _scalar_cut(kind: Integer | Float, cut: Cut, field: Field) -> Cut:
    if isinstance(kind, Integer):
        return _number_cut(cut, integer_of_bytes(kind, cut.data), field, kind)
    return Cut(cut.units, cut.name, code(_float(kind, cut.data)), markdown(field.unit or ""))


def _number_cut(cut: Cut, value: int, field: Field, kind: Integer) -> Cut:
    shown = raw_text(value, kind) if kind.role == "char" else code(value)
    return Cut(cut.units, cut.name, shown, value_meaning(value, field, kind))


def _list_cut(cut: Cut, element: Integer | Float, field: Field) -> Cut:
    data, size = cut.data, element.size
    runs = [data[start : start + size] for start in range(0, len(data), size)]
    texts = [code(_raw(element, run)) for run in runs[:_MOST_VALUES]]
    more = ["..."] if len(runs) > _MOST_VALUES else []
    return Cut(cut.units, cut.name, ", ".join(texts + more), markdown(field.about.doc))


def _raw(element: Integer | Float, data: bytes) -> int | float:
    return (
        integer_of_bytes(element, data) if isinstance(element, Integer) else _float(element, data)
    )


def _bytes_cut(cut: Cut, kind: Text | Octets, field: Field) -> Cut:
    text = cut.data.decode("latin-1").rstrip("\0") if isinstance(kind, Text) else ""
    shown = markdown(f"'{text}'") if text else ""
    return Cut(cut.units, cut.name, shown, markdown(field.about.doc))
