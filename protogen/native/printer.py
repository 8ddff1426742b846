"""Rows of tables printed as text, by C that is compiled for a schema."""

from __future__ import annotations

import ctypes
from collections.abc import Iterable, Iterator, Sequence
from fractions import Fraction
from importlib.resources import files
from typing import Any

import msgspec

from protogen.capture.arrays import numpy
from protogen.native.build import Built, compiled
from protogen.native.errors import NativeError
from protogen.native.print_steps import Steps, block, indented

_ROOM = 1 << 19
"""Bytes of text that are printed at once: the processor's cache holds them."""
_LEAST = 32
"""Bytes that every message of MCAP has at least."""
_PARAMETERS = "struct job *job, const struct rows *rows, uint8_t *out, const uint8_t *end"


class PrintedRows(msgspec.Struct):
    """Rows to be printed."""

    table: int
    """Place of its steps among those that the printer was made of."""
    rows: Any
    """A NumPy table whose rows begin with their offset."""
    differs: Any = None
    """Byte for each row: 1 if an encoder makes other bytes of it."""
    times: Any = None
    """Time of each row, in nanoseconds: `int64`."""
    timed: Any = None
    """Byte for each row: 1 if its time is known."""
    payloads: bytes = b""
    """Bytes that rows of unknown frames refer to."""


class Piece(msgspec.Struct, frozen=True):
    """Rows that were printed together."""

    text: Any
    """Bytes of an array that is used again."""
    present: Sequence[int]
    """Tables of which some rows are among them."""
    entries: Any
    """Pairs of time and place in the text of each message of MCAP: `uint64`, shape (rows, 2)."""
    tables: Any
    """Table of each message of MCAP."""


class _Job(ctypes.Structure):
    _fields_ = (
        ("line", ctypes.c_void_p),
        ("base", ctypes.c_uint64),
        ("repr", ctypes.c_void_p),
        ("release", ctypes.c_void_p),
        ("room", ctypes.c_void_p),
        ("entries", ctypes.c_void_p),
        ("tables", ctypes.c_void_p),
        ("entered", ctypes.c_uint64),
    )


class _Rows(ctypes.Structure):
    _fields_ = (
        ("rows", ctypes.c_void_p),
        ("stride", ctypes.c_uint64),
        ("count", ctypes.c_uint64),
        ("next", ctypes.c_uint64),
        ("table", ctypes.c_uint64),
        ("differs", ctypes.c_void_p),
        ("times", ctypes.c_void_p),
        ("timed", ctypes.c_void_p),
        ("payloads", ctypes.c_void_p),
    )


def build_printer(
    name: str,
    tables: Sequence[Steps],
    quoted: Iterable[int] = (),
    byte_time: Fraction = Fraction(0),
    parts: Sequence[str] = (),
) -> Built:
    """The library that prints rows of these tables; compiled unless it was before.

    `quoted`: the ASCII characters for which a value of CSV needs quotes. `byte_time`: nanoseconds
    that a byte takes on the line, for messages of MCAP. `parts`: templates that the steps need,
    too. Raises NativeError.
    """
    return compiled(name, _source(tables, quoted, byte_time, parts), ())


def _source(
    tables: Sequence[Steps], quoted: Iterable[int], byte_time: Fraction, parts: Sequence[str]
) -> str:
    templates = files("protogen.native").joinpath("templates")
    helpers = "".join(
        templates.joinpath(part).read_text("utf-8") for part in ("printer.c", "rows.c", *parts)
    )
    tests = " || ".join(f"character == {code}" for code in quoted)
    lines = [
        f"#define NEEDS_QUOTES(character) ({tests or 0})",
        f"#define LINE_TIME(bytes) ({_line_time(byte_time)})",
        helpers,
        *(line for number, steps in enumerate(tables) for line in _function(number, steps)),
        "static uint8_t *put_row(" + _PARAMETERS + ") {",
        "    switch (rows->table) {",
    ]
    for number in range(len(tables)):
        lines += [f"    case {number}:", f"        return put_{number}(job, rows, out, end);"]
    lines += ["    default:", "        return NULL;", "    }", "}"]
    return "\n".join([*lines, ""])


def _line_time(byte: Fraction) -> str:
    """C of the nanoseconds that so many `bytes` take, rounded down."""
    times, over = f"UINT64_C({byte.numerator})", f"UINT64_C({byte.denominator})"
    if byte.numerator * byte.denominator >= 1 << 64:
        return f"(uint64_t)((unsigned __int128)(bytes) * {times} / {over})"
    return f"(bytes) / {over} * {times} + (bytes) % {over} * {times} / {over}"


def _function(number: int, steps: Steps) -> Iterator[str]:
    yield f"static __attribute__((noinline)) uint8_t *put_{number}({_PARAMETERS}) {{"
    yield "    const uint8_t *const at_0 = rows->rows + (size_t)rows->next * rows->stride;"
    yield "    int is_odd = 0;"
    yield "    (void)job;"
    yield "    (void)is_odd;"
    yield from indented(block(steps))
    yield "    return out;"
    yield "}"


class Printer:
    """Prints rows. Raises NativeError where the library can't be loaded."""

    def __init__(self, built: Built) -> None:
        try:
            # It keeps the GIL, because it asks Python how long floats are spelled.
            self._print = ctypes.PyDLL(str(built.path)).protogen_print
        except OSError as error:
            raise NativeError(f"{built.path} can't be loaded: {error}") from None
        size, pointer = ctypes.c_size_t, ctypes.c_void_p
        self._print.restype = size
        self._print.argtypes = (pointer, pointer, size, pointer, size)
        self._repr = _address("PyOS_double_to_string")
        self._release = _address("PyMem_Free")
        self._make_room(_ROOM)

    def _make_room(self, size: int) -> None:
        self._room = numpy().empty(size, "u1")
        self._entries = numpy().empty((size // _LEAST, 2), "u8")
        self._tables = numpy().empty(size // _LEAST, "u4")

    def texts(self, tables: Sequence[PrintedRows], line: bytes, base: int = 0) -> Iterator[bytes]:
        """The rows of all tables by their offsets, in pieces of text.

        `line` has the bytes of the capture from offset `base` on.
        """
        return (piece.text.tobytes() for piece in self.pieces(tables, line, base))

    def pieces(self, tables: Sequence[PrintedRows], line: bytes, base: int = 0) -> Iterator[Piece]:
        """The same, each with what an index of its messages has. Until the next one is taken."""
        whole = _bytes(line)
        job = _Job(whole.ctypes.data, base, self._repr, self._release)
        payloads = [_bytes(table.payloads) for table in tables]
        pairs = zip(tables, payloads, strict=True)
        lent = (_Rows * len(tables))(*(_lent(table, held) for table, held in pairs))
        while any(table.next < table.count for table in lent):
            room, before = self._room, [table.next for table in lent]
            job.entries, job.tables = self._entries.ctypes.data, self._tables.ctypes.data
            job.entered = 0
            count = self._print(ctypes.byref(job), lent, len(lent), room.ctypes.data, len(room))
            if count:
                each = zip(lent, before, strict=True)
                present = [table.table for table, first in each if table.next > first]
                entries, numbers = self._entries[: job.entered], self._tables[: job.entered]
                yield Piece(room[:count], present, entries, numbers)
            else:  # Not even one row has room.
                self._make_room(2 * len(room))


def _bytes(data: bytes) -> Any:
    return numpy().frombuffer(data or b"\0", "u1")


def _lent(table: PrintedRows, payloads: Any) -> _Rows:
    rows = table.rows
    beside = (table.differs, table.times, table.timed, payloads)
    places = (None if item is None else item.ctypes.data for item in beside)
    return _Rows(rows.ctypes.data, rows.strides[0], len(rows), 0, table.table, *places)


def _address(name: str) -> int | None:
    return ctypes.cast(getattr(ctypes.pythonapi, name), ctypes.c_void_p).value
