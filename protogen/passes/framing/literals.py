"""Literals of a frame: fixed bytes, and several of which a frame has one."""

from __future__ import annotations

from collections import Counter

from protogen.model.origin import About
from protogen.model.parts import ChoicePart, LiteralPart, PartType
from protogen.model.types import codec
from protogen.passes.context import Context, Loc
from protogen.schema.syntax.parts import LiteralChoice, Part

_GREATEST = 254
"""Bytes of all literals together: a decoder counts in a byte how much of which it has seen."""


def literal_of(
    context: Context, loc: Loc, name: str, item: Part, about: About
) -> LiteralPart | ChoicePart | None:
    """The literal of a part, or None where it is not clear which literals there are."""
    if isinstance(item.literal, LiteralChoice):
        return _choice(context, (*loc, "literal"), name, item, item.literal, about)
    if not item.literal:
        context.error("PG147", (*loc, "literal"), "the literal has no bytes")
    if item.type is not None:
        text = "a literal is fixed bytes, which have no type"
        context.error("PG131", (*loc, "type"), text, "leave out `type`")
    return LiteralPart(
        name=name, bytes=item.literal or b"\0", unprotected=item.unprotected, about=about
    )


def _choice(
    context: Context, loc: Loc, name: str, item: Part, written: LiteralChoice, about: About
) -> ChoicePart | None:
    words, default = written.any_of, written.default
    wrong = _wrong(words)
    if wrong:
        context.error("PG190", (*loc, "any_of"), *wrong)
        return None
    if default is not None and default not in words:
        hint = f"add it to `any_of`, or choose one of {', '.join(map(_hex, words))}"
        context.error("PG190", (*loc, "default"), f"{_hex(default)} is none of the literals", hint)
        return None
    foreign = [word for word in words if not word.isascii()]
    if item.type == "ascii" and foreign:
        text = f"{_hex(foreign[0])} is no ASCII, and the part is a text"
        context.error("PG190", (*loc, "any_of"), text, "leave out `type: ascii`")
    if item.type not in (None, "ascii"):
        text = f"literals are no `{item.type}`"
        context.error("PG190", (*loc[:-1], "type"), text, "write `type: ascii`, or leave it out")
    type_ = PartType(
        bits=8 * len(words[0]),
        byte_order="big" if len(words[0]) > 1 else "little",
        role="number" if item.type is None else "ascii",
    )
    values = list(map(codec(type_).decode, words))
    return ChoicePart(
        name=name,
        type=type_,
        least=min(values),
        greatest=max(values),
        default=None if default is None else codec(type_).decode(default),
        words=words,
        unprotected=item.unprotected,
        about=about,
    )


def _wrong(words: tuple[bytes, ...]) -> tuple[str, str] | None:
    """Reason why nobody can choose one of these, and what to do about it."""
    if len(words) < 2:
        return "there is nothing to choose from", "list two literals or more, or write `literal`"
    if not all(words):
        return "a literal has no bytes", "write its bytes, or leave it out"
    if len(set(map(len, words))) > 1:
        sizes = ", ".join(f"{_hex(word)} has {len(word)}" for word in words)
        return f"the literals differ in size: {sizes}", "write those of one size in a frame"
    twice = next((word for word, count in Counter(words).items() if count > 1), None)
    if twice is not None:
        return f"{_hex(twice)} stands here twice", "remove one of them"
    together = sum(map(len, words))
    if together > _GREATEST:
        text = f"the literals have {together} bytes together, and {_GREATEST} are the most"
        return text, "list fewer of them, or make the part a number with a `range`"
    return None


def _hex(data: bytes) -> str:
    return data.hex(" ").upper()
