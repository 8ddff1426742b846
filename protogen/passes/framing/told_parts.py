"""Parts that receivers are told: how they are written, and what tells them."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from protogen.model.frame import Frame
from protogen.model.messages import Message
from protogen.model.parts import (
    CounterPart,
    IdentityPart,
    PartType,
    Teller,
    ToldLength,
    ToldPart,
    ValuePart,
)
from protogen.model.types import Array, Field, Type
from protogen.passes.context import Context, Loc
from protogen.passes.draft import Draft
from protogen.passes.framing.capacity import least_around, payload_range
from protogen.passes.framing.written_frames import WrittenFrame
from protogen.problems import hint_for

_TELLING = IdentityPart | CounterPart | ValuePart
"""Parts whose numbers a receiver hands on."""


def tellers(written: Iterable[str] | None) -> tuple[Teller, ...]:
    """What tells a part, as it is written: MESSAGE.FIELD, or a part of frames."""
    return tuple(Teller(*_split(item)) for item in written or ())


def _split(written: str) -> tuple[str, str]:
    message, dot, field = written.partition(".")
    return (message, field) if dot else ("", written)


def lone_length(context: Context, written: WrittenFrame, frame: Frame) -> bool:
    """True if a length that is told, if there is one, is all that gives a frame its size.

    What is wrong with it is reported.
    """
    told = frame.told_length
    if told is None:
        return True
    others = [part.name for part in frame.lengths if part is not told]
    beside = "" if not others else f"`{others[0]}`"
    if frame.transparency is not None:
        beside = "the delimiter behind what is stuffed"
    if frame.silence is not None:
        beside = f"the silence `{frame.silence.name}`"
    if beside:
        text = f"`{told.name}` is told and gives the size of a frame, and so does {beside}"
        context.error_at_key("PG308", (*written.loc, told.name), text, "keep one of them")
        return False
    return _has_bytes(context, written, frame, told)


def _has_bytes(context: Context, written: WrittenFrame, frame: Frame, told: ToldLength) -> bool:
    """True if there is no frame without a byte, which would be one at any place."""
    carried = payload_range(frame)
    if carried is None or carried.least > 0 or least_around(frame, empty=True) > 0:
        return True
    text = f"`{told.name}` may say that a frame has no bytes, which would be one anywhere"
    hint = f"bound it: `range: [1, {told.greatest}]`"
    context.error_at_key("PG307", (*written.loc, told.name), text, hint)
    return False


def check_told(context: Context, draft: Draft) -> None:
    """Check what tells parts that are not sent: numbers that receivers of them take."""
    known: dict[tuple[str, str], ToldPart] = {}
    for sender, frame in draft.frames.items():
        for part in frame.told:
            first = known.setdefault((context.frames[sender].endpoint, part.name), part)
            if _rule(first) != _rule(part):
                text = f"another form has a `{part.name}` that is told in another way"
                place = (*context.frames[sender].loc, part.name)
                context.error_at_key(
                    "PG306", place, text, "give both the same keys, or other names"
                )
        if frame.told:
            _check_beside(context, frame, context.frames[sender].loc)
        for part in frame.told:
            loc: Loc = (*context.frames[sender].loc, part.name, "set_by")
            for index, teller in enumerate(part.telling.set_by):
                _Telling(context, draft, loc, index, part).check(teller)


def _rule(part: ToldPart) -> tuple[object, ...]:
    """What is the same in all forms of an endpoint's frames, as they have one value of it."""
    telling = part.telling
    bounds = (part.least, part.greatest, part.counts) if isinstance(part, ToldLength) else ()
    return part.type.bits, bounds, telling.default, telling.once, telling.set_by


def _check_beside(context: Context, frame: Frame, loc: Loc) -> None:
    """Report what does not go together with identities that are not sent."""
    if frame.virtual and frame.told_identity:
        told = frame.told_identity[0]
        text = f"`{frame.virtual[0].name}` has a value for each identity, and `{told.name}` is one"
        hint = "a frame has virtual parts or told ones"
        context.error_at_key("PG306", (*loc, told.name), f"{text} that is not sent", hint)


class _Telling:
    """What tells one part, as an item of its `set_by`."""

    def __init__(
        self, context: Context, draft: Draft, loc: Loc, index: int, part: ToldPart
    ) -> None:
        self._context = context
        self._draft = draft
        self._loc = (*loc, index) if len(part.telling.set_by) > 1 else loc
        self._part = part

    def check(self, teller: Teller) -> None:
        """Report a teller that is no number, or one that the part can't hold."""
        if not teller.message:
            self._check_part(teller.name)
            return
        message = self._draft.messages.get(teller.message)
        if message is None and teller.message in self._context.syntax.messages:
            return  # Something else is wrong with it, which was said.
        if message is None:
            known = self._context.syntax.messages
            text = f"there is no message called `{teller.message}`"
            self._report(text, hint_for(teller.message, known))
            return
        self._check_field(message, teller)

    def _check_part(self, name: str) -> None:
        named = [part for part in self._sent() if part.name == name]
        if not named and name in self._written():
            return
        if not named:
            text = f"no frame has a part called `{name}` that a receiver hands on"
            known = [part.name for part in self._sent()]
            self._report(text, hint_for(name, known) or "name an identity, a counter or a value")
        for part in named[:1]:
            self._check_bits(f"`{name}`", part.type)

    def _written(self) -> set[str]:
        """The parts of frames in which something else is wrong."""
        frames = self._context.frames.items()
        return {part for name, it in frames if name not in self._draft.frames for part in it.parts}

    def _sent(self) -> Iterator[IdentityPart | CounterPart | ValuePart]:
        for frame in self._draft.frames.values():
            yield from _handed_on(frame)

    def _check_field(self, message: Message, teller: Teller) -> None:
        field = next((item for item in message.fields if item.name == teller.name), None)
        if field is None:
            text = f"`{message.name}` has no field called `{teller.name}`"
            self._report(text, hint_for(teller.name, [item.name for item in message.fields]))
            return
        number = _number_in(field)
        if number is None:
            text = f"`{teller.text}` is no unsigned integer, nor an array of such"
            self._report(text, "name a field that is one")
            return
        self._check_bits(f"`{teller.text}`", number)

    def _check_bits(self, shown: str, type_: PartType) -> None:
        if type_.is_text or type_.greatest > self._part.type.greatest:
            text = f"{shown} has values that `{self._part.name}` can't hold"
            self._report(text, f"make `{self._part.name}` as wide")

    def _report(self, text: str, hint: str | None) -> None:
        self._context.error("PG305", self._loc, text, hint)


def _handed_on(frame: Frame) -> Iterator[IdentityPart | CounterPart | ValuePart]:
    return (part for part in frame.numbers if isinstance(part, _TELLING))


def _number_in(field: Field) -> PartType | None:
    """The unsigned integer that a field is, or that the elements of an array are."""
    found: Type = field.type
    if isinstance(found, Array):
        found = found.element
    return found if isinstance(found, PartType) and not found.signed else None
