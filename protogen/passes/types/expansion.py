"""Count of the fields that declared types come to; some need to be resolved only once.

Types that hold each other twice double with every step, as the aliases of an alias bomb do.
"""

from __future__ import annotations

from typing import NamedTuple

from protogen.model.types import Struct
from protogen.passes.context import Context, Loc
from protogen.passes.types.declared import Effective
from protogen.passes.types.setting import Setting
from protogen.passes.types.type_names import Layout

GREATEST_NUMBER = 50_000
"""So many fields may come of the declared types."""


class Mark(NamedTuple):
    """Counts when a struct was begun."""

    fields: int
    varying: int


class Expansion:
    """Counts fields that come of declared types, and keeps structs that are alike everywhere."""

    def __init__(self, context: Context) -> None:
        self._context = context
        self._fields = 0
        self._varying = 0
        self._fixed: dict[tuple[str, Layout], tuple[Struct, int]] = {}
        self.is_spent = False
        """True if there were too many fields; what was built since is not whole."""

    def enter(self, loc: Loc, setting: Setting) -> bool:
        """Count a field; False where there are too many, which is said once."""
        if not setting.stack or self.is_spent:
            return not setting.stack
        self._fields += 1
        if self._fields > GREATEST_NUMBER:
            self.is_spent = True
            text = f"with this, more than {GREATEST_NUMBER} fields come of declared types"
            self._context.error_at_key("PG122", loc, text)
        return not self.is_spent

    def vary(self) -> None:
        """Note something whose bounds depend on where it stands."""
        self._varying += 1

    def mark(self) -> Mark:
        """Counts so far."""
        return Mark(self._fields, self._varying)

    def keep(self, item: Effective, struct: Struct, layout: Layout, begun: Mark) -> None:
        """Keep a declared struct, unless something in it depends on where it stands."""
        if item.declared is not None and self._varying == begun.varying:
            self._fixed[(item.declared, layout)] = (struct, self._fields - begun.fields)

    def known(self, item: Effective, layout: Layout) -> Struct | None:
        """A declared struct that was kept; its fields count again."""
        if item.declared is None or (item.declared, layout) not in self._fixed:
            return None
        struct, count = self._fixed[(item.declared, layout)]
        self._fields += count
        return struct
