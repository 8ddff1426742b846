"""Call graph of a compiled program: what a function takes along, and how deep it goes.

There is no recursion in generated C, and no call through a pointer but those of the user's own
functions, so the deepest chain of calls is exact up to the user's functions.
"""

from __future__ import annotations

from collections.abc import Iterable
from functools import cached_property

from protogen.footprint.build import Build
from protogen.footprint.elf import Section


class Graph:
    """The sections of a program and what each of them refers to."""

    def __init__(self, build: Build) -> None:
        self._build = build
        self.sections: dict[int, Section] = {item.index: item for item in build.elf.sections}
        self._needs: dict[int, set[int]] = {index: set() for index in self.sections}
        self.external: set[str] = set()
        """Functions that the compiler's library has to give."""
        for reference in build.elf.references:
            if reference.section in self.sections:
                self._add(reference.section, reference.symbol.section, reference.symbol.name)

    def _add(self, user: int, used: int | None, name: str) -> None:
        if used is None:
            self.external.add(name)
        elif used in self.sections and used != user:
            self._needs[user].add(used)

    @cached_property
    def _places(self) -> dict[str, int]:
        symbols = self._build.elf.symbols
        return {
            symbol.name: symbol.section
            for symbol in symbols
            if symbol.is_function and symbol.section is not None
        }

    @cached_property
    def functions(self) -> dict[int, str]:
        """The function that each section of code holds."""
        return {section: name for name, section in self._places.items()}

    def place(self, function: str) -> int | None:
        """The section of a function; None where the program has no such function."""
        return self._places.get(function)

    def reach(self, function: str) -> frozenset[int]:
        """The section of a function and all that it needs; none where the program lacks it."""
        found: set[int] = set()
        waiting = [self._places[function]] if function in self._places else []
        while waiting:
            section = waiting.pop()
            if section not in found:
                found.add(section)
                waiting.extend(self._needs[section])
        return frozenset(found)

    def flash(self, sections: Iterable[int]) -> int:
        """The bytes of flash of some sections."""
        chosen = (self.sections[index] for index in sections)
        return sum(item.size for item in chosen if item.is_stored)

    def stack(self, function: str) -> int:
        """The most stack that a function takes, with all that it calls."""
        place = self.place(function)
        return 0 if place is None else self._depth(place, {})

    def _depth(self, section: int, known: dict[int, int]) -> int:
        if section not in known:
            known[section] = 0  # data may point back at itself
            below = [self._depth(index, known) for index in self._needs[section]]
            known[section] = self._own(section) + max(below, default=0)
        return known[section]

    def _own(self, section: int) -> int:
        name = self.functions.get(section)
        return 0 if name is None else self._build.frames.get(name, 0)
