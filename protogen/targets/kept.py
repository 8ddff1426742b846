"""A cache of things made of protocols, or of their messages."""

from __future__ import annotations

from collections.abc import Callable
from typing import Generic, TypeVar

GivenT = TypeVar("GivenT")
MadeT = TypeVar("MadeT")


class Kept(Generic[GivenT, MadeT]):
    """Makes something of a protocol, and remembers it for some of them.

    They are known by their addresses, as to compare two takes long; one that is kept keeps its own.
    """

    def __init__(self, make: Callable[[GivenT], MadeT], most: int) -> None:
        self._make = make
        self._most = most
        self._made: dict[int, tuple[GivenT, MadeT]] = {}

    def __call__(self, given: GivenT) -> MadeT:
        """The thing made of it, now or earlier. Raises what making it raises."""
        found = self._made.get(id(given))
        if found is not None and found[0] is given:
            return found[1]
        made = self._make(given)
        while len(self._made) >= self._most:
            del self._made[next(iter(self._made))]
        self._made[id(given)] = (given, made)
        return made
