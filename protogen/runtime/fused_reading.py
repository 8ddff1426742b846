"""The text of functions that read fused structs.

For a byte, an integer of 14 bits in two bytes, and an array to the end it is about this:

    def read(data):
        if type(data) is not bytes: data = c0(data)
        v0, v1, = c1(data)
        v2 = data[3:]
        found = Container()
        found['kind'] = v0
        found['size'] = c2[v1]
        found['values'] = c3(v2)
        return found
"""

from __future__ import annotations

import io
import struct

from protogen.runtime.fused_function import Function
from protogen.runtime.fused_parts import (
    Chunk,
    Item,
    Part,
    Record,
    Scope,
    Several,
    counted,
    order_of,
)


def octets_of(data: object) -> bytes:
    """The bytes that construct would read of any buffer. Raises what it would."""
    return io.BytesIO(data).getvalue()  # type: ignore[arg-type]


class Reading:
    """Adds to a function, whose variable `data` is the bytes, what takes them apart."""

    def __init__(self, function: Function, order: str) -> None:
        self.function = function
        self.order = order
        self.run: list[tuple[str, Item]] = []
        """The variables that are still to be read, all in one."""
        self.at: int | None = 0
        """How many bytes were read; None where only the variable `at` knows."""

    def part(self, part: Part, scope: Scope = ()) -> str:
        """The expression for a part's value, behind the lines and those of `flush`."""
        match part:
            case Item():
                name, item = self.function.variable(), part.ordered(self.order)
                self.run.append((name, item))
                return self.function.through(item.read, name)
            case Several():
                elements = (self.part(part.element) for _ in range(part.count))
                return f"[{', '.join(elements)}]"
            case Record():
                values = (f"{name}={text}" for name, text in self.fields(part, scope))
                return f"Container({', '.join(values)})"
            case Chunk():
                return self._chunk(part, scope)

    def fields(self, record: Record, scope: Scope = ()) -> list[tuple[str, str]]:
        """The names of a record's fields, and the expressions for their values."""
        inner: dict[str, tuple[Part, str]] = {}
        for name, part in record.fields:
            inner[name] = part, self.part(part, (inner, *scope))
        return [(name, text) for name, (_, text) in inner.items()]

    def flush(self) -> None:
        """Read what was put off."""
        if not self.run:
            return
        layout, names = self.layout(), self.names()
        self.run = []
        place = "" if self.at == 0 else f", {self._place()}"
        self.function.lines.append(
            f"{names} = {self.function.name(layout.unpack_from)}(data{place})"
        )
        if self.at is None:
            self.function.lines.append(f"at += {layout.size}")
        else:
            self.at += layout.size

    def layout(self) -> struct.Struct:
        """That of what was put off."""
        return struct.Struct(self.order + "".join(item.code for _, item in self.run))

    def names(self) -> str:
        """The variables of what was put off, as they are assigned."""
        return "".join(f"{name}, " for name, _ in self.run).rstrip()

    def _place(self) -> str:
        return "at" if self.at is None else str(self.at)

    def _chunk(self, chunk: Chunk, scope: Scope) -> str:
        self.flush()
        name, lines = self.function.variable(), self.function.lines
        if chunk.counting is None:
            lines.append(f"{name} = data[{self._place()}:]")
            if chunk.greatest is not None:
                self.function.refuse_if(f"len({name}) > {chunk.greatest * chunk.unit}")
            if chunk.unit > 1:
                self.function.refuse_if(f"len({name}) % {chunk.unit}")
            lines.append(f"at = {self._place()} + len({name})")
        else:
            size = self._counted_size(chunk, scope)
            lines.append(f"start = {self._place()}")
            lines.append(f"at = start + {size}")
            lines.append(f"{name} = data[start:at]")
            self.function.refuse_if(f"len({name}) != at - start")
        self.at = None
        return self.function.through(chunk.read, name)

    def _counted_size(self, chunk: Chunk, scope: Scope) -> str:
        assert chunk.counting is not None
        text = counted(scope, chunk.counting.field)
        if chunk.counting.least is not None:
            limits = f"{chunk.counting.least} <= {text} <= {chunk.counting.greatest}"
            self.function.refuse_if(f"not {limits}")
        return text if chunk.unit == 1 else f"{text} * {chunk.unit}"


def read_record(record: Record, function: Function) -> int | None:
    """Give a function of `data` the lines that return the record's container.

    What it gives is the number of bytes that are read, if that is always the same.
    """
    reading = Reading(function, order_of(record))
    fields = reading.fields(record)
    reading.flush()
    if reading.at in (None, 0):  # Nothing else sees to it that these are bytes.
        convert = function.name(octets_of)
        function.lines.insert(0, f"if type(data) is not bytes: data = {convert}(data)")
    function.lines.append("found = Container()")  # With arguments it takes longer.
    function.lines += [f"found[{name!r}] = {text}" for name, text in fields]
    function.lines.append("return found")
    return reading.at
