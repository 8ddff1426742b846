"""An example as a page shows it: its bytes, and what they stand for, value by value."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import groupby

import msgspec

from protogen.model.messages import Contradiction, Example, Message
from protogen.model.parts import (
    ChecksumPart,
    IdentityPart,
    NumberPart,
    Part,
    PayloadPart,
    VirtualPart,
)
from protogen.model.protocol import Protocol
from protogen.model.reading.annotate import Row, annotate
from protogen.model.types import Field, NumberType
from protogen.targets.escape import markdown
from protogen.targets.markdown.fields.values import raw_text, value_meaning
from protogen.targets.markdown.frames.parts import identity_value, literal_text, role
from protogen.targets.markdown.text.anchors import example_anchor
from protogen.targets.markdown.text.origin import about_line
from protogen.targets.markdown.text.table import Table, View, table
from protogen.targets.markdown.text.words import (
    capital,
    code,
    hex_bytes,
    hex_number,
    sentence,
    span,
)

_HEADER = ("Byte", "Bytes", "Decoded", "Name", "Value", "Meaning")
_MOST_BYTES = 16
"""Bytes of one line that are printed."""
_MOST_VALUES = 8
"""Values of one line that are printed."""
_MOST_ELEMENTS = 32
"""Elements of an array of structs that get lines of their own."""
_LINE = 16
_FAILURES = {
    "values": "Its bytes hold other values than the document gives.",
    "unknown": "No message has its identity.",
}
_MOST_LINES = 32
"""Lines of an example's bytes that are printed; the table shows its parts anyway."""


def example_view(protocol: Protocol, message: Message, example: Example) -> View:
    """Return an example with its bytes cut into what they mean."""
    return {
        "anchor": example_anchor(message.name, example.name),
        "title": example.name,
        "about": about_line(example.about, _coverage(example)),
        "dump": _dump(example.bytes),
        "table": _bytes_table(protocol, message, example),
        "contradiction": _contradiction(example.contradicts),
    }


def _coverage(example: Example) -> str:
    if example.covers is None:
        return ""
    first, last = code(example.covers[0]), code(example.covers[-1])
    return f"Bytes of {first if first == last else f'{first} to {last}'}"


def _dump(data: bytes) -> tuple[str, ...]:
    """Print bytes in lines, with the characters behind them where all can be seen."""
    runs = [data[start : start + _LINE] for start in range(0, len(data), _LINE)]
    seen = all(0x20 <= byte < 0x7F for byte in data)
    width = len(hex_bytes(runs[0])) if runs else 0
    lines = [
        f"{hex_bytes(run):{width}}  {run.decode('ascii')}" if seen else hex_bytes(run)
        for run in runs
    ]
    more = [f"... {len(data)} bytes in all"] if len(lines) > _MOST_LINES else []
    return (*lines[:_MOST_LINES], *more)


def _contradiction(contradiction: Contradiction | None) -> str:
    if contradiction is None:
        return ""
    reads = ", ".join(
        f"{code(name)} as {code(value)}" for name, value in (contradiction.reads or {}).items()
    )
    read = f" The schema reads {reads}." if reads else ""
    failure = _FAILURES.get(contradiction.fails, f"A receiver rejects it ({contradiction.fails}).")
    return f"{failure}{read} {sentence(markdown(contradiction.why))}"


# --- the table of bytes -------------------------------------------------------------------------


class _Line(msgspec.Struct, frozen=True):
    """A row of the table; it can stand for several rows of the frame."""

    rows: Sequence[Row]
    name: str
    value: str = ""
    meaning: str = ""

    def cells(self) -> tuple[str, ...]:
        wire = b"".join(row.wire for row in self.rows)
        data = b"".join(row.bytes for row in self.rows)
        return (
            span(self.rows[0].offset, len(wire)) if wire else "",
            _bytes_text(wire),
            "" if wire == data else _bytes_text(data),
            code(self.name) if self.name else "",
            self.value,
            " ".join(filter(None, (self.meaning, *self._faults()))),
        )

    def _faults(self) -> Iterator[str]:
        for text in dict.fromkeys(_fault(row) for row in self.rows if row.fault):
            yield f"**{text}**"


def _fault(row: Row) -> str:
    """Print what is wrong; a name keeps its small letter."""
    text = sentence(markdown(row.fault))
    named = bool(row.path) and row.fault.startswith(f"{row.path} is ")
    return code(row.path) + text[len(markdown(row.path)) :] if named else capital(text)


def _bytes_table(protocol: Protocol, message: Message, example: Example) -> Table | None:
    """Return the table of an example's bytes; None if there are none to show."""
    rows = annotate(
        protocol,
        example.sender,
        example.bytes,
        covers=example.covers,
        message=message,
        told=_stated(protocol, example),
    )
    shown = [row for row in rows if row.wire or not isinstance(row.subject, PayloadPart)]
    cells = [line.cells() for line in _parts_and_fields(shown, message)]
    return table(_HEADER, cells) if example.bytes else None


def _stated(protocol: Protocol, example: Example) -> dict[str, int]:
    """The numbers of the frame that the example states."""
    numbers = protocol.sender(example.sender).frame.shown_parts
    stated = example.parts
    return {part.name: part.raw(stated[part.name]) for part in numbers if part.name in stated}


def _parts_and_fields(rows: Sequence[Row], message: Message) -> Iterator[_Line]:
    for fields, group in groupby(rows, lambda row: isinstance(row.subject, Field)):
        if fields:
            yield from _lines([*group])
        else:
            yield from (_part_line(row, message) for row in group)


def _bytes_text(data: bytes) -> str:
    if len(data) <= _MOST_BYTES:
        return code(hex_bytes(data)) if data else ""
    return f"{code(hex_bytes(data[: _MOST_BYTES - 4]))} ... {code(hex_bytes(data[-2:]))}"


# --- rows that share a line ---------------------------------------------------------------------


def _lines(rows: Sequence[Row], start: int = 0) -> Iterator[_Line]:
    """Yield the lines of rows whose paths are the same up to `start`."""
    for array, group in groupby(rows, lambda row: _array(row, start)):
        if array:
            yield from _array_lines(array, [*group])
        else:
            yield from map(_line, group)


def _array(row: Row, start: int) -> str:
    """The path of the outermost array behind `start`; empty if there is none."""
    found = row.path[: max(0, row.path.find("[", start))]
    return found or (row.path if row.run == "list" else "")


def _array_lines(array: str, rows: Sequence[Row]) -> Iterator[_Line]:
    own = [row for row in rows if row.run != "list"]
    elements = [
        (path, [*group]) for path, group in groupby(own, lambda row: _element(row.path, len(array)))
    ]
    if all(row.path == path and _is_number(row) for path, group in elements for row in group):
        yield _list_line(array, rows, own)
    elif len(elements) > _MOST_ELEMENTS:
        yield _Line(rows, array, "", f"{len(elements)} elements.")
    else:
        for path, group in elements:
            yield from _element_lines(path, group)


def _element(path: str, start: int) -> str:
    """The path of the element of an array whose own path ends at `start`."""
    return path[: path.index("]", start) + 1]


def _list_line(array: str, rows: Sequence[Row], elements: Sequence[Row]) -> _Line:
    values = ["?" if row.value is None else code(row.value) for row in elements[:_MOST_VALUES]]
    more = ["..."] if len(elements) > _MOST_VALUES else []
    return _Line(rows, array, ", ".join(values + more), _doc(rows[0]))


def _element_lines(path: str, rows: Sequence[Row]) -> Iterator[_Line]:
    """Yield the lines of one element of an array; a struct of numbers takes one."""
    own = [row for row in rows if not row.run]
    names = [row.path.removeprefix(f"{path}.") for row in own]
    if all(map(_is_number, own)) and all(map(str.isidentifier, names)):
        pairs = zip(names, own, strict=True)
        yield _Line(rows, path, ", ".join(f"{name} {_member(row)}" for name, row in pairs))
    else:
        yield from _lines(rows, len(path))


def _member(row: Row) -> str:
    """The value, and its meaning in brackets, unless that is only what its field is."""
    line = _line(row)
    return line.value if line.meaning in ("", _doc(row)) else f"{line.value} ({line.meaning})"


def _is_number(row: Row) -> bool:
    return isinstance(row.value_type, NumberType)


def _doc(row: Row) -> str:
    return markdown(row.subject.about.doc) if row.subject is not None else ""


# --- values and meanings ------------------------------------------------------------------------


def _part_line(row: Row, message: Message) -> _Line:
    value, meaning = "", ""
    if isinstance(row.subject, Part):
        value, meaning = _part_value(row), role(row.subject)
    if isinstance(row.subject, IdentityPart):
        meaning = code(message.name)
    return _Line((row,), row.path, value, meaning or sentence(markdown(row.meaning)))


def _part_value(row: Row) -> str:
    part = row.subject
    if not isinstance(row.value, int):
        return ""
    if isinstance(part, IdentityPart):
        return identity_value(part, row.value)
    if isinstance(part, ChecksumPart):
        return code(hex_number(row.value, part.type.bits))
    if isinstance(part, NumberPart | VirtualPart) and part.type.is_text:
        return literal_text(part.encode(row.value))
    return code(row.value)


def _line(row: Row) -> _Line:
    """Return the line of a field, or of a part of one."""
    assert isinstance(row.subject, Field)
    return _Line((row,), row.path, _value(row), _meaning(row, row.subject))


def _value(row: Row) -> str:
    if isinstance(row.value, str):
        text = row.value.rstrip("\0")
        return markdown(f"'{text}'") if text else ""
    if row.value is None:
        return ""
    if isinstance(row.value_type, NumberType) and row.value_type.role == "char":
        return raw_text(int(row.value), row.value_type)
    return code(row.value)


def _meaning(row: Row, field: Field) -> str:
    if isinstance(row.value, int) and isinstance(row.value_type, NumberType):
        return value_meaning(row.value, field, row.value_type)
    if isinstance(row.value, float):
        return markdown((row.meaning if field.scaled else field.unit) or field.about.doc)
    if row.run:
        return f"{row.meaning}, {markdown(row.type)}"
    if row.value_type is None and not row.fault:
        return "Raw bytes, as no case has this value."
    return markdown(field.about.doc)
