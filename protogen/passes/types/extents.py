"""Extents: the number of elements or bytes of a field."""

from __future__ import annotations

from protogen.model.nesting import can_count
from protogen.model.types import Counted, Extent, Field, Fill, Fixed
from protogen.passes.context import Context, Loc
from protogen.passes.types.setting import Setting
from protogen.problems import hint_for
from protogen.schema.syntax.fields import Fill as FillSyntax

Written = int | str | FillSyntax | None


class Extents:
    """Resolves `count` and `size`. What the schema does not bound is bounded by the frame."""

    def __init__(self, context: Context) -> None:
        self._context = context

    def extent(self, written: Written, loc: Loc, element: int, setting: Setting) -> Extent:
        """Number of elements of at least `element` bytes."""
        if isinstance(written, FillSyntax):
            return self._fill(written, loc, element, setting)
        if isinstance(written, str):
            return self._counted(written, loc, element, setting)
        return Fixed(count=written or 0)

    def _fill(self, written: FillSyntax, loc: Loc, element: int, setting: Setting) -> Fill:
        if not setting.delimited:
            text = "the frame does not say where the payload ends, so nothing can fill it"
            self._context.error("PG118", loc, text, "give a count, or a length part to the frame")
        elif written.max is None and setting.room is None:
            text = "nothing bounds this: the frame has no length part"
            self._context.error("PG118", loc, text, "give it a bound: {fill: true, max: 64}")
        if written.max is not None:
            return Fill(greatest=written.max, stated=True)
        return Fill(greatest=(setting.room or 0) // element)

    def _counted(self, name: str, loc: Loc, element: int, setting: Setting) -> Extent:
        field = setting.outer.get(name)
        if field is None:
            if not setting.elsewhere:
                text = f"no earlier field is called `{name}`"
                self._context.error("PG116", loc, text, hint_for(name, setting.outer))
            return Fixed(count=0)
        if not can_count(field.type):
            text = f"`{name}` can't count: it is not an unsigned integer"
            self._context.error("PG117", loc, text)
            return Fixed(count=0)
        return _counted_by(field, element, setting.room)


def _counted_by(field: Field, element: int, room: int | None) -> Counted:
    if isinstance(field.const, int):
        return Counted(field=field.name, least=field.const, greatest=field.const, stated=True)
    least, greatest = int(field.least or 0), int(field.greatest or 0)
    if room is not None and not field.ranged:
        greatest = min(greatest, room // element)
    return Counted(field=field.name, least=least, greatest=greatest, stated=field.ranged)
