"""Fills tables by generated C."""

from __future__ import annotations

import ctypes
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

from protogen.capture.arrays import dtype_of, numpy
from protogen.capture.memory import Lender, Memory
from protogen.capture.tables import Tables
from protogen.live.rows import driver_of
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
    driver = driver_of(protocol, sender)
    built = build(driver)
    if built.path not in _LIBRARIES:
        _LIBRARIES[built.path] = Library(built.path, driver)
    return _LIBRARIES[built.path]


def address_of(data: bytes | memoryview) -> int:
    """Address of the bytes, which have to stay there."""
    found: int = numpy().frombuffer(data, "u1").ctypes.data
    return found


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
        self, library: Library, budget: int = BUDGET, memory: Lender | None = None
    ) -> None:
        self._schema = library.schema
        self._decoder = Decoder(library, budget)
        tables = [*library.schema.messages.values(), library.schema.invalid, library.schema.unknown]
        # In the library's order.
        self._dtypes: list[np.dtype[Any]] = [*map(dtype_of, tables), numpy().dtype("u1")]
        self._empty: list[Rows] = [numpy().zeros(0, dtype) for dtype in self._dtypes]
        self._budget = budget
        self.memory: Lender = memory or Memory()
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
        """True if a table is, so that `run` took fewer bytes than it could."""
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
        """True if that was done."""
        return self._decoder.is_joined

    @property
    def place(self) -> tuple[int, int]:
        """The offset of the first byte that no event covers yet, and the next event's number."""
        return self._decoder.offset, self._decoder.sequence

    def take(self) -> Tables:
        """Tables that were held."""
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
            dtype = self._dtypes[number]
            if rate * size * dtype.itemsize > _FEW:
                most = max(1, self._budget // dtype.itemsize)
                count = min(most, int(rate * size * 1.1) + 8)
                found[number] = self.memory.rows(number, dtype, count)
                self._decoder.lend(number, found[number])
        return found

    def _tables(self, lent: dict[int, Rows], taken: int) -> Tables:
        decoder = self._decoder
        every = list(self._empty)
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
        *messages, invalid, unknown, payloads = every
        found = Tables(
            schema=self._schema,
            engine=self.name,
            messages=dict(zip(self._schema.messages, messages, strict=True)),
            invalid=invalid,
            unknown=unknown,
            payloads=payloads,
            offset=self._offset,
            size=decoder.offset - self._offset,
            sequence=self._sequence,
            events=decoder.sequence - self._sequence,
        )
        self._offset, self._sequence = decoder.offset, decoder.sequence
        decoder.clear()
        return found


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
