"""Rows of tables as text, by a C program that is compiled once, whatever the schema.

What is printed for a row is a list of steps; `protogen/native/templates/printer.c` says what each
of them does.
"""

from __future__ import annotations

import ctypes
import struct
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from enum import IntEnum
from functools import cache
from typing import Any, NamedTuple

from protogen.capture.arrays import numpy
from protogen.native.build import build_printer
from protogen.native.errors import NativeError

CODES = ("u1", "i1", "u2", "i2", "u4", "i4", "u8", "i8", "f4", "f8")
"""Types of numbers, in the order of `enum code`."""
BESIDE = -100
"""The source of what lies beside the element of a list."""
DEPTH = 16
"""Lists inside of lists, and the row around them."""
_ROOM = 1 << 19
"""Bytes of text that are printed at once: the processor's cache holds them."""
_SLACK = 16
"""C copies texts in pieces of so many bytes."""
_OPERAND = [("source", "i4"), ("code", "i4"), ("offset", "i8")]
_STEP = [("kind", "i4"), ("a", "i4"), ("b", "i8"), ("c", "i8"), ("x", _OPERAND), ("y", _OPERAND)]


class Kind(IntEnum):
    """What a step does: `enum kind`."""

    END = 0
    TEXT = 1
    INTEGER = 2
    PLACE = 3
    FLOAT = 4
    NAME = 5
    STRING = 6
    HEX = 7
    SPAN = 8
    COPY = 9
    LIST = 10
    FIXED = 11
    NEXT = 12
    SWITCH = 13
    JUMP = 14
    IF = 15
    ODD = 16
    QUOTE = 17
    UNQUOTE = 18


class Operand(NamedTuple):
    """Where a value is: in a column, or in the element of a list or the row at hand."""

    source: int = 0
    """A column's number; -1: in the element at hand, -2: in the one around it, and so on."""
    code: int = 0
    """The place of its type in `CODES`."""
    offset: int = 0
    """Bytes."""


class Step(NamedTuple):
    """`struct step`."""

    kind: Kind
    a: int = 0
    b: int = 0
    c: int = 0
    x: Operand = Operand()
    y: Operand = Operand()


@dataclass(frozen=True, slots=True)
class Script:
    """All programs of a printer, and what they share."""

    steps: Sequence[Step]
    pool: bytes
    """Fixed texts, one behind the other."""
    texts: Sequence[tuple[int, int]]
    """Place in the pool and size of the texts that steps choose among."""
    choices: Sequence[tuple[int, int]]
    """Value and step of each case of a switch."""
    escapes: Sequence[Sequence[bytes]]
    """Tables: how each of 256 characters is spelled."""
    special: bytes = bytes(256)
    """For each byte, 1 if values of CSV that have it need quotes."""


@dataclass(frozen=True, slots=True)
class Table:
    """Rows to be printed."""

    columns: Sequence[Any]
    """NumPy arrays with an item for each row; bytes that all rows share."""
    program: int
    """Its first step."""
    rows: int
    offsets: int = 0
    """The column with the offsets, by which rows of several tables are put in order."""


class _Printer(ctypes.Structure):
    _fields_ = (
        ("steps", ctypes.c_void_p),
        ("pool", ctypes.c_void_p),
        ("texts", ctypes.c_void_p),
        ("choices", ctypes.c_void_p),
        ("escapes", ctypes.c_void_p),
        ("special", ctypes.c_void_p),
        ("repr", ctypes.c_void_p),
        ("release", ctypes.c_void_p),
        ("start", ctypes.c_uint64),
        ("base", ctypes.c_uint64),
        ("nan4", ctypes.c_uint8 * 8),
        ("nan8", ctypes.c_uint8 * 8),
    )


class _Table(ctypes.Structure):
    _fields_ = (
        ("columns", ctypes.c_void_p),
        ("strides", ctypes.c_void_p),
        ("rows", ctypes.c_int64),
        ("next", ctypes.c_int64),
        ("program", ctypes.c_int64),
        ("offsets", ctypes.c_int64),
    )


class Printer:
    """Prints rows by the programs of a script. Raises NativeError where there is no compiler."""

    def __init__(self, script: Script) -> None:
        self._print = _function()
        np = numpy()
        spellings = [_spelling(text) for table in script.escapes for text in table]
        shared = (
            np.array([tuple(step) for step in script.steps], _STEP),
            np.frombuffer(script.pool + bytes(_SLACK), "u1"),
            np.array(script.texts or [(0, 0)], "i8"),
            np.array([(_in_64_bits(it), step) for it, step in script.choices] or [(0, 0)], "i8"),
            np.frombuffer(b"".join(spellings) or b"\0", "u1"),
            np.frombuffer(script.special, "u1"),
        )
        self._shared = shared  # C looks at it.
        self._printer = _Printer(
            *(item.ctypes.data for item in shared),
            _address("PyOS_double_to_string"),
            _address("PyMem_Free"),
            nan4=_bits("=f4x"),
            nan8=_bits("=d"),
        )
        self._room = np.empty(_ROOM, "u1")

    def texts(self, tables: Sequence[Table], start: int = 0, base: int = 0) -> Iterator[bytes]:
        """The rows of all tables as text, in pieces.

        `start` is added to what is printed as a place; `base` is the offset of the first byte of
        the line that the tables have as a column.
        """
        lent = [_lent(table) for table in tables]
        given = (_Table * len(lent))(*(table for table, _ in lent))
        while any(table.next < table.rows for table in given):
            self._printer.start, self._printer.base = start, base
            room = self._room
            count = self._print(
                ctypes.byref(self._printer), given, len(lent), room.ctypes.data, len(room)
            )
            if count:
                yield room[:count].tobytes()
            else:  # Not even one row has room.
                self._room = numpy().empty(2 * len(room), "u1")


def _lent(table: Table) -> tuple[_Table, Any]:
    """The table for C, and what has to stay as long as it is used."""
    np = numpy()
    columns = [
        np.frombuffer(item or b"\0", "u1") if isinstance(item, bytes) else item
        for item in table.columns
    ]
    places = np.array([item.ctypes.data for item in columns], "u8")
    pairs = zip(columns, table.columns, strict=True)
    strides = np.array([0 if isinstance(it, bytes) else item.strides[0] for item, it in pairs])
    strides = strides.astype("i8")
    data = (places.ctypes.data, strides.ctypes.data, table.rows, 0, table.program, table.offsets)
    return _Table(*data), (columns, places, strides)


def _spelling(text: bytes) -> bytes:
    return bytes([len(text)]) + text.ljust(7, b"\0")


def _in_64_bits(value: int) -> int:
    """The number as C compares it, where the greatest of `u8` are negative."""
    return (value ^ 1 << 63) % (1 << 64) - (1 << 63)


def _bits(format: str) -> Any:
    """The NaN that a text is read as."""
    return (ctypes.c_uint8 * 8)(*struct.pack(format, float("nan")))


def _address(name: str) -> int | None:
    return ctypes.cast(getattr(ctypes.pythonapi, name), ctypes.c_void_p).value


@cache
def _function() -> Any:
    path, _ = build_printer()
    try:
        # It keeps the GIL, because it asks Python how long floats are spelled.
        function = ctypes.PyDLL(str(path)).protogen_print
    except OSError as error:
        raise NativeError(f"{path} can't be loaded: {error}") from None
    size, pointer = ctypes.c_size_t, ctypes.c_void_p
    function.restype, function.argtypes = size, (pointer, pointer, size, pointer, size)
    return function
