"""A cache of things made of protocols."""

from __future__ import annotations

from collections.abc import Callable
from typing import Generic, TypeVar

from protogen.model.protocol import Protocol

MadeT = TypeVar("MadeT")


class Kept(Generic[MadeT]):
    """Makes something of a protocol, and remembers it for some protocols.

    They are known by their addresses, as to compare two takes long; one that is kept keeps its own.
    """

    def __init__(self, make: Callable[[Protocol], MadeT], most: int) -> None:
        self._make = make
        self._most = most
        self._made: dict[int, tuple[Protocol, MadeT]] = {}

    def __call__(self, protocol: Protocol) -> MadeT:
        """The thing made of the protocol, now or earlier. Raises what making it raises."""
        found = self._made.get(id(protocol))
        if found is not None and found[0] is protocol:
            return found[1]
        made = self._make(protocol)
        while len(self._made) >= self._most:
            del self._made[next(iter(self._made))]
        self._made[id(protocol)] = (protocol, made)
        return made
