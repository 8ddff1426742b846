"""Names of bits of parts: none is taken twice, and none stands where whole bytes are meant."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from protogen.model.frame import Frame
from protogen.passes.context import Context, Loc
from protogen.schema.syntax.parts import Part


def check_names(context: Context, loc: Loc, parts: Mapping[str, Part]) -> None:
    """Report bits that are called as another part of the frame is, or as other bits."""
    seen = dict.fromkeys(parts, "another part of the frame")
    for holder, item in parts.items():
        for name in item.bits or {}:
            if name in seen:
                text = f"`{name}` is {seen[name]}, and these bits are called so, too"
                place = (*loc, holder, "bits", name)
                context.error_at_key("PG258", place, text, "give one of them another name")
            seen[name] = f"some bits of `{holder}`" if name not in parts else seen[name]


def holders_of(parts: Mapping[str, Part]) -> dict[str, str]:
    """The parts that have bits with names, by these."""
    return {
        name: holder
        for holder, item in parts.items()
        for name in item.bits or {}
        if name not in parts
    }


def are_whole(
    context: Context, holders: Mapping[str, str], written: Sequence[str], loc: Loc
) -> bool:
    """True if a run of parts names no bits, whose holders these are; else that is reported."""
    found = [name for name in dict.fromkeys(_names(written)) if name in holders]
    for name in found:
        text = f"`{name}` is some bits of `{holders[name]}`, and whole bytes are meant here"
        context.error("PG259", loc, text, f"name `{holders[name]}`")
    return not found


def _names(written: Iterable[str]) -> list[str]:
    return [name for item in written for name in item.split("..")]


def place_of_number(loc: Loc, frame: Frame, name: str) -> Loc:
    """The place of a number of a frame, which is a part or some bits of one."""
    if any(part.name == name for part in frame.told):
        return (*loc, name)
    holder = frame.holder(name).name
    return (*loc, holder) if holder == name else (*loc, holder, "bits", name)
