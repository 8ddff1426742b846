"""How many there are of what a terminator, or its last element, ends."""

from __future__ import annotations

import msgspec

from protogen.passes.context import Context, Loc
from protogen.passes.types.setting import Setting
from protogen.schema.syntax.fields import Until, UntilElement


class Ending(msgspec.Struct, frozen=True):
    """What ends it, in the words of problems."""

    code: str
    name: str
    """What it is."""
    example: str
    """How it is written with a bound."""
    instead: str
    """What to write where the number is always the same."""
    least: int
    """The least number that there may be, where the schema does not say it."""


def bounds_within(
    context: Context,
    written: Until | UntilElement,
    loc: Loc,
    setting: Setting,
    greatest: int,
    ending: Ending,
) -> tuple[int, int]:
    """The least and the greatest number; `greatest` is what the schema or the frame allows.

    Where nothing bounds it, or nothing is left to what ends it, that is reported.
    """
    is_bounded = written.max is not None or setting.room is not None
    if not is_bounded:
        text = "nothing bounds this: the frame has no length part"
        # Where fields tell the payload's size, they do it by what they say, not by the room.
        everywhere = ", or all frames: `max_frame: 256`" if setting.delimited else ""
        hint = f"give it a bound: `{ending.example}`{everywhere}"
        context.error(ending.code, loc, text, hint)
    elif written.min >= greatest:
        _no_choice(context, written, loc, greatest, ending)
        return ending.least, max(ending.least + 1, greatest)
    return written.min, greatest


def _no_choice(
    context: Context, written: Until | UntilElement, loc: Loc, greatest: int, ending: Ending
) -> None:
    """Report bounds that leave nothing to what ends it."""
    if written.min > greatest:
        what = "`max` allows" if written.max is not None else "the frame has room for"
        text, hint = f"{written.min} are more than the {greatest} that {what}", None
    else:
        text = f"there are always {greatest}, so nothing depends on {ending.name}"
        hint = f"write {ending.instead}"
    context.error(ending.code, loc, text, hint)
