"""Check that the forms of frame on one line go together, and that a receiver tells them apart."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import combinations
from typing import TypeVar

from protogen.copying import replace
from protogen.model.frame import Frame
from protogen.model.framing import AfterEnd, Framing, StartLiteral, StartSet
from protogen.model.parts import (
    BitsPart,
    ChoicePart,
    LengthPart,
    LiteralPart,
    MirrorBits,
    NumberPart,
    PayloadPart,
    members_of,
)
from protogen.passes.context import Context
from protogen.passes.draft import Draft
from protogen.passes.proofs.wire_code import EVERY_BYTE, ByteSet, part_bytes

_HELD = LiteralPart | ChoicePart | LengthPart
"""Parts of which a receiver takes no other values than the schema allows."""
_Number = TypeVar("_Number", bound=NumberPart)


def check_forms(context: Context, draft: Draft) -> None:
    """The forms of each endpoint, in pairs."""
    if context.syntax.forms is None:
        return
    _alone(context)
    needed: set[str] = set()
    for endpoint in context.syntax.endpoints:
        own = [name for name in draft.framings if context.frames[name].endpoint == endpoint]
        if len(own) > 1 and _go_together(context, draft, own):
            needed |= _told_apart(context, draft, own)
    for name, form in context.syntax.forms.items():
        if form.behind is not None and name not in needed and draft.framings:
            text = f"frames of `{name}` begin like those of no form above, so there is nothing"
            place = ("forms", name, "behind")
            context.error("PG144", place, f"{text} to accept", "remove `behind`")


def _alone(context: Context) -> None:
    """With forms, frames and transparencies stand in these."""
    for key, word in (("frame", "frames"), ("transparency", "transparencies")):
        if any(getattr(context.syntax, key).values()):
            text = f"a schema with `forms` has its {word} there"
            context.error_at_key("PG171", (key,), text, f"move `{key}` into a form")


def _go_together(context: Context, draft: Draft, names: Sequence[str]) -> bool:
    """True if one search finds the starts of all forms."""
    first = draft.framings[names[0]]
    is_idle = draft.frames[names[0]].silence is not None
    for name in names[1:]:
        framing = draft.framings[name]
        if is_idle != (draft.frames[name].silence is not None):
            one, other = context.frames[names[0]].form, context.frames[name].form
            text = f"a silence alone ends frames of only one of `{one}` and `{other}`"
            hint = "let it end both, or neither"
            context.error_at_key("PG174", context.frames[name].loc[:-1], text, hint)
            return False
        if _kind_of_start(framing) != _kind_of_start(first):
            text = f"frames of `{context.frames[name].form}` are found in another way than those"
            context.error_at_key(
                "PG174",
                context.frames[name].loc[:-1],
                f"{text} of `{context.frames[names[0]].form}`",
                "let each form begin with a literal, or with a first byte of a range of its own",
            )
            return False
    return True


def _kind_of_start(framing: Framing) -> object:
    """What has to be the same in all forms."""
    start, end = framing.start, framing.end
    if isinstance(start, StartLiteral | StartSet):
        unique = b"" if end is None or not end.protected else end.bytes
        is_shared = isinstance(start, StartLiteral) and start.bytes == unique
        return start if is_shared else StartLiteral
    return end if isinstance(start, AfterEnd) else type(start)


def _told_apart(context: Context, draft: Draft, names: Sequence[str]) -> set[str]:
    """The forms that need a decision; one that has none is reported."""
    needed: set[str] = set()
    for above, below in combinations(names, 2):
        if _are_distinct(draft, above, below):
            continue
        form, other = context.frames[below].form, context.frames[above].form
        needed.add(form)
        if context.frames[below].behind is None:
            context.error_at_key(
                "PG173",
                ("forms", form),
                f"nothing at its beginning tells a frame of `{form}` from one of `{other}`",
                "tell them apart by a literal, constant bits or ranges of a length in one place, "
                f"or accept that `{other}` wins: `behind:` and a decision's name",
            )
    return needed


def _are_distinct(draft: Draft, one: str, other: str) -> bool:
    """True if a byte, or a length, in front of stuffing and payload is never the same in both."""
    pairs = zip(_beginning(draft, one), _beginning(draft, other), strict=False)
    return any(first.isdisjoint(second) for first, second in pairs) or any(
        length.greatest < second.least or second.greatest < length.least
        for offset, length in _lengths(draft.frames[one])
        for place, second in _lengths(draft.frames[other])
        if (offset, length.type) == (place, second.type)
    )


def _lengths(frame: Frame) -> Iterator[tuple[int, LengthPart]]:
    """The lengths in front of stuffing and payload, whole parts and bits, with their offsets."""
    offset = 0
    for part in frame.parts:
        if isinstance(part, PayloadPart) or part.name in frame.stuffed:
            return
        for item in members_of(part) or (part,):
            if isinstance(item, LengthPart):
                yield offset, item
        offset += part.size


def _beginning(draft: Draft, sender: str) -> Iterator[ByteSet]:
    """Values of each byte in front of stuffing and payload."""
    frame, start = draft.frames[sender], draft.framings[sender].start
    for part in frame.parts:
        if isinstance(part, PayloadPart) or part.name in frame.stuffed:
            return
        if isinstance(part, _HELD) or (isinstance(start, StartSet) and part is frame.parts[0]):
            yield from part_bytes(part, EVERY_BYTE)
        elif isinstance(part, BitsPart):
            yield from part_bytes(_held_bits(part), EVERY_BYTE)
        else:
            yield from (EVERY_BYTE,) * part.size


def _held_bits(part: BitsPart) -> BitsPart:
    """The part with all values that a receiver takes: bits that are the same, or a length, hold."""
    members = tuple(_held(member) for member in part.members)
    mirrors = tuple(_held_mirror(mirror) for mirror in part.mirrors)
    return replace(part, members=members, mirrors=mirrors)


def _held_mirror(mirror: MirrorBits) -> MirrorBits:
    return replace(mirror, of=_held(mirror.of))


def _held(number: _Number) -> _Number:
    """A number with the bounds to which a receiver holds it."""
    if isinstance(number, LengthPart):
        return number
    return replace(number, least=number.type.least, greatest=number.type.greatest)
