"""A compiled driver, loaded with ctypes. Its functions run without the GIL."""

from __future__ import annotations

import ctypes
from pathlib import Path
from typing import TYPE_CHECKING, Any
from weakref import finalize

from protogen.capture.arrays import numpy
from protogen.native.driver import Driver
from protogen.native.errors import NativeError

if TYPE_CHECKING:
    from protogen.capture.tables import Rows


WORDS = 8
"""`struct protogen_table`: rows, count, room, lent, lent_count, own, own_capacity, skipped."""


_FEW = 1 << 12
"""Bytes that take some microseconds at most."""


class State(ctypes.Structure):
    """Members of `struct protogen_capture` in front of the tables."""

    _fields_ = (
        ("offset", ctypes.c_uint64),
        ("sequence", ctypes.c_uint64),
        ("payloads", ctypes.c_uint64),
        ("budget", ctypes.c_uint64),
        ("frame", ctypes.c_uint64),
        ("front", ctypes.c_uint64 * 3),
        ("is_told", ctypes.c_uint32),
        ("is_joined", ctypes.c_uint32),
        ("is_full", ctypes.c_uint32),
        ("failed", ctypes.c_uint32),
    )


class Library:
    """The functions of a driver. Raises NativeError unless its rows lie as the schema says."""

    def __init__(self, path: Path, driver: Driver) -> None:
        try:
            library = ctypes.CDLL(str(path))
            # What is done at once keeps the GIL: to get it back may take longer.
            quick = ctypes.PyDLL(str(path))
        except OSError as error:
            raise NativeError(f"{path} can't be loaded: {error}") from None
        self.schema = driver.schema
        expected = (ctypes.sizeof(State), *driver.layout)
        found = (ctypes.c_size_t * len(expected)).in_dll(library, "protogen_layout")
        if tuple(found) != expected:
            raise NativeError("the compiler lays structs out in a way of its own")
        rows = (*self.schema.messages.values(), self.schema.invalid, self.schema.unknown)
        self.sizes = (*(table.row.size for table in rows), 1)
        self.tables = len(self.sizes)
        pointer, size, long = ctypes.c_void_p, ctypes.c_size_t, ctypes.c_uint64
        self.new = _function(quick, "protogen_new", pointer, long)
        self.free = _function(quick, "protogen_free", None, pointer)
        self.start = _function(quick, "protogen_start", None, pointer, long, long)
        self.feed = _function(library, "protogen_feed", size, pointer, pointer, size)
        self.feed_few = _function(quick, "protogen_feed", size, pointer, pointer, size)
        beyond = (pointer, pointer, size, size, long)
        self.feed_on = _function(library, "protogen_feed_on", size, *beyond)
        self.join = _function(library, "protogen_join", ctypes.c_int, pointer, pointer)
        self.tell = _function(quick, "protogen_tell", None, pointer, pointer)
        self.flush = _function(library, "protogen_flush", None, pointer)
        self.lend = _function(quick, "protogen_lend", None, pointer, size, pointer, size)
        self.clear = _function(quick, "protogen_clear", None, pointer)
        self._spell = None
        if driver.spells:
            spell = (size, pointer, size, pointer, long, pointer)
            self._spell = _function(library, "protogen_spell", ctypes.c_int, *spell)
            others = (pointer, size, pointer, pointer, long, pointer)
            name = "protogen_spell_unknown"
            self._spell_unknown = _function(library, name, ctypes.c_int, *others)

    def differs(self, number: int, rows: Rows, line: bytes, start: int) -> Rows:
        """For each row of a table, whether an encoder makes other bytes of it than `line` has.

        `start` is the offset of the line's first byte.
        """
        assert self._spell is not None
        whole = numpy().ascontiguousarray(rows)
        found: Rows = numpy().zeros(len(rows), "u1")
        data = numpy().frombuffer(line, "u1")
        places = (data.ctypes.data, start, found.ctypes.data)
        if not self._spell(number, whole.ctypes.data, len(rows), *places):
            raise MemoryError
        return found

    def unknown_differ(self, rows: Rows, payloads: Rows, line: bytes, start: int) -> Rows:
        """The same for the table of unknown frames."""
        whole, bytes_of = numpy().ascontiguousarray(rows), numpy().ascontiguousarray(payloads)
        found: Rows = numpy().zeros(len(rows), "u1")
        data = numpy().frombuffer(line, "u1")
        places = (bytes_of.ctypes.data, data.ctypes.data, start, found.ctypes.data)
        if not self._spell_unknown(whole.ctypes.data, len(rows), *places):
            raise MemoryError
        return found


class Decoder:
    """A stream that becomes rows of tables: those of the messages, invalid, unknown, payloads.

    Rows go into memory that was lent for them, and behind its end into memory of the table's own.
    Then, or when that has `budget` bytes, the table is full: it takes what the bytes at hand still
    bring, and `feed` returns.
    """

    def __init__(self, library: Library, budget: int) -> None:
        self._library = library
        self._pointer = library.new(budget)
        if not self._pointer:
            raise MemoryError
        # When Python ends, threads that nobody waits for may be decoding still.
        finalize(self, library.free, self._pointer).atexit = False
        self._state = State.from_address(self._pointer)
        words = ctypes.c_size_t * (library.tables * WORDS)
        memory = words.from_address(self._pointer + ctypes.sizeof(State))
        self._tables = memoryview(memory).cast("B").cast("P")

    def start(self, offset: int, sequence: int) -> None:
        """Begin a stream: offset of its first byte, number of its first event."""
        self._library.start(self._pointer, offset, sequence)

    def lend(self, number: int, memory: Rows) -> None:
        """Lend memory for the rows of a table; until `clear`, which forgets it."""
        self._library.lend(self._pointer, number, memory.ctypes.data, len(memory))

    def feed(self, address: int, size: int) -> int:
        """Take bytes at an address until a table is full. Returns how many were taken."""
        feed = self._library.feed_few if size <= _FEW else self._library.feed
        taken: int = feed(self._pointer, address, size)
        self._check()
        return taken

    def feed_on(self, address: int, part: int, size: int, end: int) -> int:
        """Take the bytes of a part, and up to `size` bytes until a frame behind it is complete.

        `end` is the offset where the part ends. Returns how many bytes were taken.
        """
        taken: int = self._library.feed_on(self._pointer, address, part, size, end)
        self._check()
        return taken

    def join(self, front: Decoder) -> bool:
        """Let rows count from where `front`, the decoder of the part in front, fed on to.

        Their numbers go on as there. False: there is no frame that both have, or a table is full.
        """
        return bool(self._library.join(self._pointer, front._pointer))

    def tell(self, front: Decoder) -> None:
        """Say where `front` fed on to, so that `feed_on`, which may be at work, can join it."""
        self._library.tell(self._pointer, front._pointer)

    @property
    def is_joined(self) -> bool:
        """True if `join` came about."""
        return bool(self._state.is_joined)

    @property
    def joined(self) -> tuple[int, int] | None:
        """The offset from which on rows count, and the first number, once it was joined."""
        _, offset, number = self._state.front
        return (offset, number) if self._state.is_joined else None

    def flush(self) -> None:
        """Take the end of the stream."""
        self._library.flush(self._pointer)
        self._check()

    def clear(self) -> None:
        """Forget the rows, and what was lent."""
        self._library.clear(self._pointer)

    def renumber(self, more: int) -> None:
        """The numbers of the next events are greater by so many, which may be less than none."""
        self._state.sequence += more

    @property
    def is_full(self) -> bool:
        """True if a table is."""
        return bool(self._state.is_full)

    @property
    def offset(self) -> int:
        """Of the first byte that no event covers yet."""
        return int(self._state.offset)

    @property
    def sequence(self) -> int:
        """The number of the next event."""
        return int(self._state.sequence)

    def filled(self) -> list[tuple[int, slice, int, int]]:
        """The tables with rows: number, those in lent memory, how many in its own, and where."""
        words = self._tables.tolist()
        found = []
        each = zip(words[1::WORDS], words[3::WORDS], strict=True)
        for number in [it for it, (count, lent) in enumerate(each) if count or lent]:
            rows, count, _, lent, lent_count, own, _, skipped = words[
                number * WORDS : (number + 1) * WORDS
            ]
            if lent:
                is_lent = rows == lent
                place = slice(skipped, count if is_lent else lent_count)
                found.append((number, place, 0 if is_lent else count, own))
            elif count > skipped:
                own += skipped * self._library.sizes[number]
                found.append((number, slice(0), count - skipped, own))
        return found

    def _check(self) -> None:
        if self._state.failed:
            raise MemoryError


def _function(library: ctypes.CDLL, name: str, result: Any, *arguments: Any) -> Any:
    function = getattr(library, name)
    function.restype, function.argtypes = result, arguments
    return function
