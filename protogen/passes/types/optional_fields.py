"""Fields at the end of a message that may be left out."""

from __future__ import annotations

from protogen.model.types import Field
from protogen.passes.context import Context, Loc
from protogen.passes.types.declared import Effective

_ALONE = ("when", "const", "default")
"""Keys that say something about a field that only the payload's end leaves out."""
_WHY = {
    "when": "either a condition or the end of the payload says whether it is there",
    "const": "a value that is always the same says nothing by being there",
    "default": "where it is there, its value has to be given",
}


def is_optional(context: Context, name: str, item: Effective) -> bool:
    """True if a field may be left out; where it can't be, that is reported."""
    if not item.syntax.optional:
        return False
    loc = item.at("optional")
    if any(link.optional for link, _ in item.chain[1:]):
        text = "a declared type is there wherever it is used"
        context.error("PG288", loc, text, "write `optional` where the type is used")
    elif not _is_of_record(item.chain[0][1]) and item.setting.in_tail:
        text = "a case is there if its value says so, and is not left out by itself"
        hint = "give the case `fields`, the last of which may be left out"
        context.error("PG288", loc, text, hint)
    elif not item.setting.in_tail:
        text = f"`{name}` is in something that does not end the payload, and may be left out"
        hint = "say by a `when` whether it is there, or move what it is in to the end"
        context.error("PG288", loc, text, hint)
    elif not item.setting.delimited:
        text = (
            f"the frame does not say where the payload ends, so nothing says if `{name}` is there"
        )
        hint = "give a length part or an end to the frame, or say it by a `when`"
        context.error("PG289", loc, text, hint)
    else:
        return _stands_alone(context, name, item)
    return False


def _is_of_record(loc: Loc) -> bool:
    """True for a field of a message or struct; a case of a switch is none."""
    return loc[-2] == "fields"


def _stands_alone(context: Context, name: str, item: Effective) -> bool:
    """True if no other key says what `optional` says, or the contrary."""
    for key in _ALONE:
        if getattr(item.syntax, key) is not None:
            text = f"`{name}` is optional and has a `{key}`: {_WHY[key]}"
            context.error_at_key("PG288", item.at(key), text, f"leave out the `{key}`")
            return False
    return True


def check_tail(context: Context, front: str, found: Field, loc: Loc) -> None:
    """Check a field behind `front`, which may be left out, if there is one."""
    if front and not found.optional:
        text = f"`{found.name}` is always there, behind `{front}`, which may be left out"
        hint = f"write `optional: true` for `{found.name}`, too, or move it in front of `{front}`"
        context.error_at_key("PG287", loc, text, hint)
    if found.optional and found.sizes_there.least == 0:
        text = f"`{found.name}` may have no bytes, so nothing tells whether it is there"
        hint = "give it a byte at least, or leave out `optional`"
        context.error_at_key("PG288", loc, text, hint)
