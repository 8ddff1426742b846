"""Runs of parts of a frame, such as `first..last`."""

from __future__ import annotations

from collections.abc import Sequence

from protogen.passes.context import Context, Loc
from protogen.problems import hint_for


def written_out(
    context: Context, names: Sequence[str], written: Sequence[str], loc: Loc
) -> tuple[str, ...]:
    """The parts that are meant, of a frame with these `names`: `first..last` written out.

    They are in wire order; none, where one of them is unknown.
    """
    chosen: set[str] = set()
    for item in written:
        ends = item.split("..")
        unknown = next((name for name in ends if name not in names), None)
        if unknown is not None:
            text = f"the frame has no part called `{unknown}`"
            context.error("PG132", loc, text, hint_for(unknown, names))
            return ()
        first, last = names.index(ends[0]), names.index(ends[-1])
        if first > last:
            context.error("PG132", loc, f"`{ends[0]}` comes behind `{ends[-1]}`")
        chosen.update(names[first : last + 1])
    return tuple(name for name in names if name in chosen)
