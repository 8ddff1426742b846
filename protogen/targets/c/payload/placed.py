"""Walks over payloads in memory, which go by the place of the next value.

As long as all sizes are known the place is the payload's own pointer and an offset. Where they are
not, a second pointer `at` is moved, but only if something follows.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from protogen.c_language.numbers import unsigned
from protogen.model.payload_plan import (
    ChooseStep,
    NumberStep,
    OptionalStep,
    RegionStep,
    RepeatStep,
)
from protogen.targets.c.lines import Lines
from protogen.targets.c.payload.helpers import Helpers
from protogen.targets.c.payload.walk import Walk, amount, times


class PlacedWalk(Walk):
    """A walk that goes by the place in memory of the next byte."""

    def __init__(self, helpers: Helpers, lines: Lines, pointer: str) -> None:
        """Begin at `payload`; `pointer` is the type of `at`, as `uint8_t *`."""
        super().__init__(helpers, lines)
        self._pointer = pointer
        self._name = "payload"
        self._offset = 0
        self._index = ""  # What an index adds, as `2 * i`.
        self._pending = ""  # What has to be added before anything else is done.

    def byte(self, index: int = 0) -> str:
        """The byte that lies there, or so many bytes behind."""
        self.catch_up()
        place = self._offset + index
        if not self._index:
            return f"{self._name}[{place}]"
        return f"{self._name}[{' + '.join(filter(None, [_term(place), self._index]))}]"

    def address(self) -> str:
        """The address of what lies there."""
        self.catch_up()
        return self._sum(self._name)

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
            self.lines.add(f"{self._pointer}at = {self._sum('payload')};")
        elif self._offset or self._pending:
            self.lines.add(f"at += {self._sum('') if self._pending else unsigned(self._offset)};")
        self.settled()

    def settled(self) -> None:
        """Every branch has left `at` at the place itself."""
        self._name, self._offset, self._pending = "at", 0, ""

    def catch_up(self) -> None:
        """Leave nothing to be added that varies, before there are several ways on."""
        if self._pending:
            self.settle()

    def _sum(self, start: str) -> str:
        if not self._index and not self._pending:  # As in all that has no arrays.
            offset = str(self._offset or "")
            return f"{start} + {offset}" if start and offset else start or offset
        terms = [start, _term(self._offset), self._index, self._pending]
        return " + ".join(term for term in terms if term)

    # --- elements and cases -----------------------------------------------------------------------

    @contextmanager
    def group(self, count: int, size: int) -> Iterator[str]:
        """A loop over groups of packed numbers, which have a pointer of their own."""
        self.catch_up()
        with self.loop(count) as index, self.branch():
            self._index = f"{unsigned(size)} * {index}" if size > 1 else index
            self._point(index)
            yield index
        self.skip(count * size)

    def _point(self, index: str) -> None:
        """Have a pointer of its own for what the index says."""
        self.lines.add(f"{self._pointer}at_{index} = {self.address()};")
        self._name, self._offset, self._index = f"at_{index}", 0, ""

    def elements(self, step: RepeatStep, place: str, count: int | str) -> None:
        """Walk over elements one by one."""
        element, size = step.element, step.element.known_size
        if size is None:
            self.settle()
            with self.loop(count) as index:
                self.step(element, f"{place}[{index}]")
                self.settle()
            return
        self.catch_up()
        with self.loop(count) as index, self.branch():
            self._index = f"{unsigned(size)} * {index}" if size > 1 else index
            if not isinstance(element, NumberStep):  # Several values have a pointer of their own.
                self._point(index)
            self.step(element, f"{place}[{index}]")
        self.skip(times(count, size))

    def choose(self, step: ChooseStep, place: str) -> None:
        """One of several cases; behind it, `at` stands where the case has ended."""
        with self._joined(step, is_known=isinstance(step.selector, int)):
            super().choose(step, place)

    def optional(self, step: OptionalStep, place: str) -> None:
        """A step that may be there; behind it, `at` stands where it has ended."""
        with self._joined(step, is_known=isinstance(step.presence.holds, int)):
            super().optional(step, place)

    def region(self, step: RegionStep, place: str) -> None:
        """What takes just so many bytes; behind it, `at` stands where they end."""
        bytes_ = amount(self.count(step.region))
        self.settle()
        end = "" if step.is_last else self.variable("region_end")
        if end:
            self.lines.add(f"{self._pointer}const {end} = at + {bytes_};")
        with self.branch(), self.inside(bytes_, step):
            self.step(step.step, place)
        if end:
            self.lines.add(f"at = {end};")
            self.settled()

    @contextmanager
    def inside(self, size: str, step: RegionStep) -> Iterator[None]:
        """Surroundings of what is printed for a region of so many bytes, which begins at `at`."""
        yield

    @contextmanager
    def _joined(self, step: ChooseStep | OptionalStep, *, is_known: bool) -> Iterator[None]:
        """Several ways, which go on together unless nothing follows."""
        size = step.known_size
        joins = not step.is_last and not is_known
        if joins and size is None:
            self.settle()
        self.catch_up()
        yield
        if joins and size is None:
            self.settled()
        elif joins:
            self.skip(size or 0)

    @contextmanager
    def branch(self) -> Iterator[None]:
        """One of several ways on from here."""
        before = self._name, self._offset, self._index, self._pending
        yield
        self._name, self._offset, self._index, self._pending = before

    def end_branch(self, step: ChooseStep | OptionalStep) -> None:
        """Settle where this way has ended, if something follows."""
        if not step.is_last and step.known_size is None:
            self.settle()


def _term(number: int) -> str:
    """A number of bytes in a sum with others; nothing where there are none."""
    return unsigned(number) if number else ""
