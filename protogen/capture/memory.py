"""Memory that rows are written to."""

from __future__ import annotations

import sys
from threading import Lock
from typing import TYPE_CHECKING, Any, Protocol
from weakref import finalize

from protogen.capture.arrays import numpy

if TYPE_CHECKING:
    import numpy as np

    from protogen.capture.tables import Rows

_LITTLE = 1 << 17
"""Bytes that come out of the process's own heap."""


class Lender(Protocol):
    """Memory for the rows of a capture."""

    rates: dict[int, float]
    """Rows for a byte of the capture, as far as is known, of the tables that have some."""

    def rows(self, number: int, dtype: np.dtype[Any], count: int) -> Rows:
        """Rows of any content, for a table by its number; there may be some fewer."""


class _Holder:
    """Holder of a reference to memory."""

    __slots__ = ("memory",)

    def __init__(self, memory: Any) -> None:
        self.memory = memory

    @property
    def references(self) -> int:
        """References to the memory, as Python counts."""
        return sys.getrefcount(self.memory)


_UNUSED = _Holder(bytearray()).references
"""References that are counted where nobody else uses memory. From 3.14 on, Python counts fewer."""


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
        """True if anybody refers to it."""
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
"""Blocks that readings of this process use one after another."""
MOST_KEPT = 96 << 20
"""Bytes that are kept for the next reading."""


class Memory:
    """Memory that is used again when nobody looks at it any more."""

    def __init__(self, blocks: Blocks | None = None) -> None:
        self.rates: dict[int, float] = {}
        self._blocks = blocks or Blocks()
        finalize(self, self._blocks.trim, MOST_KEPT)

    def rows(self, number: int, dtype: np.dtype[Any], count: int) -> Rows:
        """Rows of any content, for whatever table."""
        if count * dtype.itemsize < _LITTLE:
            return numpy().empty(count, dtype)  # type: ignore[no-any-return]
        return self._blocks.rows(dtype, count)
