"""Setting of a field: the payload around it."""

from __future__ import annotations

from collections import ChainMap

import msgspec

from protogen.copying import replace
from protogen.model.sizes import SizeSet
from protogen.model.types import Field
from protogen.passes.framing.capacity import GREATEST_FRAME
from protogen.passes.types.type_names import Layout

Scope = ChainMap[str, Field]
"""Earlier fields by name, those of the innermost struct first."""


class Setting(msgspec.Struct, frozen=True):
    """Surroundings in which the fields at hand are built."""

    layout: Layout
    capacity: int | None
    """Greatest payload in bytes, where the frame bounds it."""
    owner: str
    """Prefix for the names of unnamed enums and structs."""
    delimited: bool = True
    """True if the frame tells where the payload ends."""
    last: bool = True
    """True if nothing of the payload follows."""
    in_tail: bool = True
    """True if nothing of the payload follows the struct or message that the field is in."""
    used: int = 0
    """The least number of bytes of the payload in front."""
    position: int | None = 0
    """The number of bytes of the struct or message in front, where it is always the same; None
    for bits that are packed."""
    outer: Scope = msgspec.field(default_factory=ChainMap)
    """Fields that counts and switches may name, from the structs around."""
    stack: tuple[str, ...] = ()
    """Declared types that are being resolved, the outermost first."""
    depth: int = 0
    """Structs and declared types around."""
    leads: bool = True
    """True if a separator stands in front, where fields have some."""
    elsewhere: bool = False
    """True if these fields stand in no frame that is known: names may mean fields around them."""

    @property
    def room(self) -> int | None:
        """The greatest number of bytes that are left, where the frame bounds them."""
        return None if self.capacity is None else max(0, self.capacity - self.used)

    def inside(
        self, name: str, behind: SizeSet, outer: Scope, *, first: bool, last: bool
    ) -> Setting:
        """The setting of the field `name`, behind so many bytes of earlier fields."""
        return replace(
            self,
            used=self.used + behind.least,
            position=None if self.layout.packed else behind.fixed,
            owner=f"{self.owner}_{name}",
            outer=outer,
            leads=self.leads or not first,
            last=self.last and last,
            in_tail=self.last,
        )


def nowhere(layout: Layout, owner: str) -> Setting:
    """The setting of fields that stand in no frame, so that they still can be checked."""
    known = replace(layout, byte_order=layout.byte_order or "little")
    return Setting(layout=known, capacity=GREATEST_FRAME, owner=owner, elsewhere=True)
