"""Place of the next value in a payload, while statements are printed for one after another."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from protogen.targets.c.lines import Lines


class Place:
    """A pointer into the payload and what has to be added to it.

    As long as all sizes are known the pointer is the payload's own. Where they are not, a second
    pointer `at` is moved, but only if something follows.
    """

    def __init__(self, lines: Lines, pointer: str) -> None:
        """`pointer` is the type of `at`, as `uint8_t *`."""
        self._lines = lines
        self._pointer = pointer
        self._name = "payload"
        self._offset = 0
        self._index = ""  # What an index adds, as `2 * i`.
        self._pending = ""  # What has to be added before anything else is done.

    def byte(self, index: int = 0) -> str:
        """The byte that lies there, or so many behind."""
        self.catch_up()
        return f"{self._name}[{self._sum('', self._offset + index) or '0'}]"

    def address(self) -> str:
        """The address of what lies there."""
        self.catch_up()
        return self._sum(self._name, self._offset)

    def skip(self, size: int | str) -> None:
        """Go on behind so many bytes."""
        if not size:
            return
        self.catch_up()
        if isinstance(size, int):
            self._offset += size
        else:
            self._pending = size

    def settle(self) -> None:
        """Have `at` point to the place itself."""
        if self._name == "payload":
            self._lines.add(f"{self._pointer}at = {self._sum('payload', self._offset)};")
        elif self._offset or self._pending:
            self._lines.add(f"at += {self._sum('', self._offset)};")
        self.settled()

    def settled(self) -> None:
        """Every branch has left `at` at the place itself."""
        self._name, self._offset, self._pending = "at", 0, ""

    @property
    def passed(self) -> tuple[str, int]:
        """The pointer, and how far behind it the place is."""
        self.catch_up()
        return self._name, self._offset

    @contextmanager
    def branch(self) -> Iterator[None]:
        """One of several ways on from here."""
        before = self._name, self._offset, self._index, self._pending
        yield
        self._name, self._offset, self._index, self._pending = before

    @contextmanager
    def element(self, size: int, index: str, *, several: bool) -> Iterator[None]:
        """An element of an array that starts here; `several` values have a pointer of their own."""
        with self.branch():
            self._index = f"{size} * {index}" if size > 1 else index
            if several:
                self._lines.add(f"{self._pointer}at_{index} = {self.address()};")
                self._name, self._offset, self._index = f"at_{index}", 0, ""
            yield

    def catch_up(self) -> None:
        """Leave nothing to be added that varies, before there are several ways on."""
        if self._pending:
            self.settle()

    def _sum(self, start: str, offset: int) -> str:
        terms = [start, str(offset) if offset else "", self._index, self._pending]
        return " + ".join(term for term in terms if term)
