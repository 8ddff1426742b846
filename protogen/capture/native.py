"""Fills tables by generated C."""

from __future__ import annotations

import ctypes
import sys
from collections.abc import Iterator
from pathlib import Path
from threading import Lock
from typing import TYPE_CHECKING, Any
from weakref import finalize

from protogen.capture.arrays import dtype_of, numpy
from protogen.capture.schema import CaptureSchema
from protogen.capture.tables import Tables
from protogen.model.protocol import Protocol, Sender
from protogen.native.build import build
from protogen.native.library import Decoder, Library

if TYPE_CHECKING:
    import numpy as np

    from protogen.capture.tables import Rows

BUDGET = 16 << 20
"""Bytes of a table that is full. A batch ends there."""
_LIBRARIES: dict[Path, Library] = {}
"""Those that were loaded: nobody unloads them."""


def library_of(protocol: Protocol, sender: Sender) -> Library:
    """The library for what `sender` sends. Raises NativeError."""
    built = build(protocol, sender)
    if built.path not in _LIBRARIES:
        _LIBRARIES[built.path] = Library(built.path, built.driver)
    return _LIBRARIES[built.path]


def address_of(data: bytes | memoryview) -> int:
    """Where the bytes lie, which have to stay there."""
    found: int = numpy().frombuffer(data, "u1").ctypes.data
    return found


class Dtypes:
    """The dtypes of all tables, in the library's order, and empty tables."""

    def __init__(self, schema: CaptureSchema) -> None:
        tables = [*schema.messages.values(), schema.invalid, schema.unknown]
        self.each: list[np.dtype[Any]] = [*map(dtype_of, tables), numpy().dtype("u1")]
        self.empty: list[Rows] = [numpy().zeros(0, dtype) for dtype in self.each]


class _Holder:
    """What refers to memory."""

    __slots__ = ("memory",)

    def __init__(self, memory: Any) -> None:
        self.memory = memory

    @property
    def references(self) -> int:
        """How many there are to the memory, as Python counts."""
        return sys.getrefcount(self.memory)


_UNUSED = _Holder(bytearray()).references
"""What is counted where nobody else uses memory. From 3.14 on, Python counts fewer."""


class _Block(_Holder):
    """Memory that is lent, over and over. No thread waits here for another that looks at it."""

    __slots__ = ("_busy", "size")
    memory: Rows

    def __init__(self, size: int) -> None:
        super().__init__(numpy().empty(size, "u1"))
        self._busy = Lock()
        self.size = size

    @property
    def is_used(self) -> bool:
        """Whether anybody refers to it."""
        return self.references > _UNUSED

    def lent(self, size: int) -> Rows | None:
        """So many bytes of it; None if it is used, or of quite another size."""
        if not size <= self.size <= 4 * size or not self._busy.acquire(blocking=False):
            return None
        try:
            return None if self.is_used else self.memory[:size]
        finally:
            self._busy.release()


class Blocks:
    """Blocks of memory. What nobody looks at any more is used again, the oldest block first.

    Fresh pages cost more than decoding into them does; and the fewer are used in turn, the more of
    them are in a cache still. No thread waits here for another: in the middle of this, Python may
    come upon a reading that is over, and trim; or upon one that nobody goes on with, and wait for
    its threads, which need blocks. A block that gets lost to the list by that is not used again.
    """

    def __init__(self) -> None:
        self._blocks: list[_Block] = []

    def rows(self, dtype: np.dtype[Any], count: int) -> Rows:
        """Rows of any content."""
        size = count * dtype.itemsize
        for block in self._blocks:
            found = block.lent(size)
            if found is not None:
                return found.view(dtype)
        return self._added(size + size // 8)[:size].view(dtype)

    def _added(self, size: int) -> Rows:
        """All of a new block. Those that suited nobody are given back."""
        block = _Block(size)
        memory = block.memory  # It is used before others can find it.
        self._blocks = [*(other for other in self._blocks if other.is_used), block]
        return memory

    def trim(self, most: int) -> None:
        """Keep so many bytes. What somebody looks at still is the first to be forgotten."""
        kept = []
        for block in sorted(self._blocks, key=lambda block: block.is_used):
            if block.size <= most:
                most -= block.size
                kept.append(block)
        self._blocks = kept


KEPT = Blocks()
"""What readings of this process use one after another."""
MOST_KEPT = 96 << 20
"""Bytes that are kept for the next reading."""


class Memory:
    """Memory for the rows of a capture."""

    def __init__(self, blocks: Blocks | None = None) -> None:
        self.rates: dict[int, float] = {}
        """Rows for a byte of the capture, as far as is known, of the tables that have some."""
        self._blocks = blocks or Blocks()
        finalize(self, self._blocks.trim, MOST_KEPT)

    def rows(self, dtype: np.dtype[Any], count: int) -> Rows:
        """Rows of any content."""
        if count * dtype.itemsize < _LITTLE:
            return numpy().empty(count, dtype)  # type: ignore[no-any-return]
        return self._blocks.rows(dtype, count)


_LITTLE = 1 << 17
"""Bytes that come out of the process's own heap."""
_FEW = 1 << 12
"""Bytes of a capture, or of rows, that are sooner copied than memory is found for rows."""
_TELLING = 1 << 13
"""Bytes of a capture that tell how many rows there will be in as many again."""


class NativeEngine:
    """A stream that becomes tables, some bytes at a time.

    C writes rows where they stay: it is lent as much memory as the last bytes needed.
    """

    name = "native"

    def __init__(
        self, library: Library, budget: int = BUDGET, memory: Memory | None = None
    ) -> None:
        self._schema = library.schema
        self._decoder = Decoder(library, budget)
        self._dtypes = Dtypes(library.schema)
        self._budget = budget
        self.memory = memory or Memory()
        self._held: dict[int, Rows] = {}
        self._offset = 0
        self._sequence = 0

    def start(self, offset: int, sequence: int = 0) -> None:
        """Begin a stream at this byte of the capture; the first event has this number."""
        self._decoder.start(offset, sequence)
        self._offset, self._sequence = offset, sequence

    def renumber(self, more: int) -> None:
        """The numbers of the next events are greater by so many."""
        self._sequence += more
        self._decoder.renumber(more)

    def feed(self, data: bytes | memoryview) -> Iterator[Tables]:
        """Take the next bytes of the stream."""
        view, taken = memoryview(data), 0
        while taken < len(view):
            count, found = self.step(view[taken:])
            taken += count
            yield found
            del found  # So that memory which the caller lets go is used again.

    def step(self, data: bytes | memoryview) -> tuple[int, Tables]:
        """Take some of the next bytes, until a table is full: how many, and what came of them."""
        try:
            lent = self._lend(len(data)) if len(data) > _FEW else {}
            taken = self._decoder.feed(address_of(data), len(data))
            return taken, self._tables(lent, taken)
        except BaseException:
            self._decoder.clear()  # Nobody keeps what was lent any more.
            raise

    def run(self, data: memoryview, part: int, end: int) -> int:
        """Take the bytes of a part, and those behind it until a frame is complete: how many.

        `part` bytes lead to the offset `end`. What comes of them is held until `take`.
        """
        try:
            self._held = self._lend(part)
            return self._decoder.feed_on(address_of(data), part, len(data), end)
        except BaseException:
            self._decoder.clear()  # Nobody keeps what was lent any more.
            raise

    @property
    def is_full(self) -> bool:
        """Whether a table is, so that `run` took fewer bytes than it could."""
        return self._decoder.is_full

    def join(self, front: NativeEngine) -> bool:
        """Let what is held count from where the part in front ran on to, and number it on.

        False: there is no frame that both have, as far as is known.
        """
        return self._decoder.join(front._decoder)

    def tell(self, front: NativeEngine) -> None:
        """Say where the part in front ran on to: `run`, which may be at work, can join it then."""
        self._decoder.tell(front._decoder)

    @property
    def is_joined(self) -> bool:
        """Whether that was done."""
        return self._decoder.is_joined

    @property
    def place(self) -> tuple[int, int]:
        """The offset of the first byte that no event covers yet, and the next event's number."""
        return self._decoder.offset, self._decoder.sequence

    def take(self) -> Tables:
        """What was held."""
        lent, self._held = self._held, {}
        self._offset, self._sequence = self._decoder.joined or (self._offset, self._sequence)
        return self._tables(lent, self._decoder.offset - self._offset)

    def flush(self) -> Iterator[Tables]:
        """Take the end of the stream."""
        self._decoder.flush()
        yield self._tables({}, 0)

    def _lend(self, size: int) -> dict[int, Rows]:
        """Memory for what so many bytes may bring."""
        found: dict[int, Rows] = {}
        for number, rate in self.memory.rates.items():
            dtype = self._dtypes.each[number]
            if rate * size * dtype.itemsize > _FEW:
                most = max(1, self._budget // dtype.itemsize)
                found[number] = self.memory.rows(dtype, min(most, int(rate * size * 1.1) + 8))
                self._decoder.lend(number, found[number])
        return found

    def _tables(self, lent: dict[int, Rows], taken: int) -> Tables:
        decoder = self._decoder
        every = list(self._dtypes.empty)
        rates: dict[int, float] = {}
        for number, in_lent, in_own, own in decoder.filled():
            rows = lent[number][in_lent] if number in lent else every[number]
            if in_own:
                rows = appended(rows, own, in_own)
            elif len(rows) * 4 < len(lent[number]):
                rows = appended(rows, 0, 0)
            every[number] = rows
            rates[number] = len(rows) / max(1, taken)
        if taken >= _TELLING:
            self.memory.rates = rates
        found = tables_of(
            self._schema,
            every,
            (self._offset, decoder.offset),
            (self._sequence, decoder.sequence),
        )
        self._offset, self._sequence = decoder.offset, decoder.sequence
        decoder.clear()
        return found


def tables_of(
    schema: CaptureSchema, every: list[Rows], offsets: tuple[int, int], numbers: tuple[int, int]
) -> Tables:
    """Tables in the library's order: first and next offset, first and next number."""
    *messages, invalid, unknown, payloads = every
    return Tables(
        schema=schema,
        engine=NativeEngine.name,
        messages=dict(zip(schema.messages, messages, strict=True)),
        invalid=invalid,
        unknown=unknown,
        payloads=payloads,
        offset=offsets[0],
        size=offsets[1] - offsets[0],
        sequence=numbers[0],
        events=numbers[1] - numbers[0],
    )


def appended(rows: Rows, address: int, count: int) -> Rows:
    """The rows, and behind them those at an address."""
    size = count * rows.dtype.itemsize
    if not len(rows) and size <= _FEW:  # To ask where an array lies takes longer than this.
        few: Rows = numpy().frombuffer(bytearray(ctypes.string_at(address, size)), rows.dtype)
        return few
    found: Rows = numpy().empty(len(rows) + count, rows.dtype)
    place = found.ctypes.data
    if len(rows):
        ctypes.memmove(place, rows.ctypes.data, rows.nbytes)
    ctypes.memmove(place + rows.nbytes, address, size)
    return found
