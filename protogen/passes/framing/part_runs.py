"""Runs of parts of a frame, such as `first..last`."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from protogen.passes.context import Context, Loc
from protogen.problems import hint_for


class Runs:
    """Writes out runs of the parts of one frame."""

    def __init__(self, context: Context, names: Iterable[str]) -> None:
        self._context = context
        self.names = list(names)
        """The frame's parts, in wire order."""

    def run(self, written: Sequence[str], loc: Loc) -> tuple[str, ...]:
        """The names of parts, with `first..last` written out, in wire order."""
        chosen: set[str] = set()
        for item in written:
            ends = item.split("..")
            if not self._all_known(ends, loc):
                return ()
            first, last = self.names.index(ends[0]), self.names.index(ends[-1])
            if first > last:
                self._context.error("PG132", loc, f"`{ends[0]}` comes behind `{ends[-1]}`")
            chosen.update(self.names[first : last + 1])
        return tuple(name for name in self.names if name in chosen)

    def _all_known(self, wanted: Sequence[str], loc: Loc) -> bool:
        for name in wanted:
            if name not in self.names:
                text = f"the frame has no part called `{name}`"
                self._context.error("PG132", loc, text, hint_for(name, self.names))
                return False
        return True
