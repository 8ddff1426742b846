"""The text of functions that write fused structs.

For a byte, an integer of seven bits, and an array to the end it is about this:

    def write(values):
        if type(values) is not dict and type(values) is not Container: raise Unclear
        if len(values) != 3: c0(values, c1)
        v0 = values['size']
        if not 0 <= v0 <= 127: raise Unclear
        v1 = values['values']
        return c2(values['kind'], v0) + c3(v1)
"""

from __future__ import annotations

import struct
from collections.abc import Mapping

from protogen.runtime.fused_function import Function
from protogen.runtime.fused_parts import (
    Chunk,
    Constant,
    Item,
    Part,
    Record,
    Scope,
    Several,
    Steps,
    counted,
    order_of,
)
from protogen.runtime.pairs import Unclear

COPIED = 5
"""From so many fields on it pays to copy a Container: Python looks faster into a plain dict."""


def check_names(values: Mapping[object, object], known: frozenset[str]) -> None:
    """Nothing is there but fields and what construct adds itself. Raises Unclear."""
    for name in values:
        if name not in known and not str(name).startswith("_"):
            raise Unclear


class Writing:
    """Adds to a function what puts bytes together."""

    def __init__(self, function: Function, order: str) -> None:
        self.function = function
        self.order = order
        self.run: list[tuple[str, Item]] = []
        """The values that are still to be written, all in one."""
        self.pieces: list[str] = []
        """The expressions whose bytes follow each other."""

    def part(self, part: Part, value: str, scope: Scope = ()) -> str:
        """Add the lines for the value of a part. What it gives is the text of the value."""
        match part:
            case Item():
                return self._item(part.ordered(self.order), value)
            case Several():
                self._several(part, self._variable(value))
            case Record():
                self._record(part, self._variable(value), scope)
            case Chunk():
                self._chunk(part, self._variable(value), scope)
        return value

    def _several(self, several: Several, values: str) -> None:
        self.function.refuse_if(f"type({values}) is not list and type({values}) is not tuple")
        self.function.refuse_if(f"len({values}) != {several.count}")
        for index in range(several.count):
            self.part(several.element, f"{values}[{index}]")

    def _variable(self, text: str) -> str:
        name = self.function.variable()
        self.function.lines.append(f"{name} = {text}")
        return name

    def _item(self, item: Item, value: str) -> str:
        if item.constant is not None:
            value = self._constant(item.constant, value)
        elif item.write:
            value = self._variable(value)
        self._check(item.write, value)
        self.run.append((self.function.through(item.write, value), item))
        return value

    def _constant(self, constant: Constant, value: str) -> str:
        given, due = self._variable(value), self.function.name(constant.value)
        self.function.refuse_if(f"{given} is not None and {given} != {due}")
        return due

    def _check(self, steps: Steps, value: str) -> None:
        for step in steps:
            if step.wrong:
                uses = {name: self.function.name(value) for name, value in step.uses.items()}
                self.function.refuse_if(step.wrong.format(v=value, **uses))

    def _record(self, record: Record, values: str, scope: Scope) -> None:
        self._check_fields(record, values)
        inner: dict[str, tuple[Part, str]] = {}
        for name, part in record.fields:
            text = f"{values}.get({name!r})" if _may_be_missing(part) else f"{values}[{name!r}]"
            inner[name] = part, self.part(part, text, (inner, *scope))

    def _check_fields(self, record: Record, values: str) -> None:
        """Check what the fields are in, and that no others are."""
        lines, names = self.function.lines, [name for name, _ in record.fields]
        if len(names) < COPIED:
            self.function.refuse_if(
                f"type({values}) is not dict and type({values}) is not Container"
            )
        else:
            lines.append(f"if type({values}) is not dict:")
            lines.append(f"    if type({values}) is not Container: raise Unclear")
            lines.append(f"    {values} = {{**{values}}}")
        missing = [name for name, part in record.fields if _may_be_missing(part)]
        odd = [f"len({values}) != {len(names)}", *(f"{name!r} not in {values}" for name in missing)]
        check, known = self.function.name(check_names), self.function.name(frozenset(names))
        lines.append(f"if {' or '.join(odd)}: {check}({values}, {known})")

    def _chunk(self, chunk: Chunk, value: str, scope: Scope) -> None:
        self.flush()
        if chunk.counting is not None:
            count = counted(scope, chunk.counting.field)
            self.function.refuse_if(f"type({count}) is not int or len({value}) != {count}")
            if chunk.counting.least is not None:
                limits = f"{chunk.counting.least} <= {count} <= {chunk.counting.greatest}"
                self.function.refuse_if(f"not {limits}")
        elif chunk.greatest is not None:
            self.function.refuse_if(f"len({value}) > {chunk.greatest}")
        self._check(chunk.write, value)
        self.pieces.append(self.function.through(chunk.write, value))

    def flush(self) -> None:
        """Write what was put off."""
        if self.run:
            layout = struct.Struct(self.order + "".join(item.code for _, item in self.run))
            texts = ", ".join(text for text, _ in self.run)
            self.pieces.append(f"{self.function.name(layout.pack)}({texts})")
            self.run = []

    def bytes(self) -> str:
        """The expression for all bytes."""
        self.flush()
        return " + ".join(self.pieces) or "b''"


def _may_be_missing(part: Part) -> bool:
    return isinstance(part, Item) and part.constant is not None


def write_record(record: Record, function: Function, values: str) -> None:
    """Give a function the lines that return the bytes of the record in a variable."""
    writing = Writing(function, order_of(record))
    writing.part(record, values)
    function.lines.append(f"return {writing.bytes()}")
