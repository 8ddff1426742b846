"""Literals that open and close a frame: can they also occur inside of it?"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Sequence

import msgspec

from protogen.model.frame import Frame
from protogen.model.messages import Message
from protogen.model.parts import ChoicePart, LiteralPart, Part
from protogen.passes.context import Context, Loc
from protogen.passes.framing.capacity import head_literals, joined_words, tail_literals
from protogen.passes.framing.open_payloads import open_payload
from protogen.passes.proofs.codewords import occurs
from protogen.passes.proofs.wire_code import ByteSet, segments


class Delimiter(msgspec.Struct, frozen=True):
    """Literals that stand together at one end of a frame."""

    parts: tuple[LiteralPart | ChoicePart, ...]
    words: tuple[bytes, ...]
    """Bytes of the literals together: one word, or several where there is a choice."""
    witness: tuple[bytes, int] | None
    """A frame that has a word in another place, and where; None: there is none."""

    @property
    def protected(self) -> bool:
        """True if it occurs nowhere else in a frame."""
        return self.witness is None


class Delimiters(msgspec.Struct, frozen=True):
    """Delimiters of the frames of one sender."""

    head: Delimiter | None
    tail: Delimiter | None


def delimiters_of(frame: Frame, payload: ByteSet) -> Delimiters:
    """The delimiters of a frame whose payload is of such bytes.

    An end may be the start of the next frame as well where both are one literal alone: a receiver
    of several could not tell which of them a byte is.
    """
    head, tail = head_literals(frame), tail_literals(frame)
    is_choice = any(isinstance(part, ChoicePart) for part in head)

    def delimiter(parts: tuple[LiteralPart | ChoicePart, ...]) -> Delimiter | None:
        if not parts:
            return None
        own = parts if is_choice else (*head, *tail)
        stretches = segments(frame, payload, (part.name for part in own))
        words = joined_words(parts)
        found = (occurs(word, b"", stretches, b"") for word in words)
        witness = next((item for item in found if item is not None), None)
        return Delimiter(parts, words, witness)

    return Delimiters(delimiter(head), delimiter(tail))


class Sent(msgspec.Struct, frozen=True):
    """What an endpoint sends, as far as its delimiters depend on it."""

    sender: str
    frame: Frame
    delimiters: Delimiters
    messages: Sequence[Message]
    payload: ByteSet
    """The bytes that its payloads can hold."""


def judge_delimiters(context: Context, senders: Iterable[Sent]) -> None:
    """Report what is not protected and not accepted; senders of one frame are judged together."""
    alike: dict[Loc, list[tuple[Sent, Delimiter]]] = defaultdict(list)
    for sent in senders:
        loc, found = context.frames[sent.sender].loc, sent.delimiters
        for delimiter in filter(None, (found.head, found.tail)):
            alike[*loc, delimiter.parts[0].name].append((sent, delimiter))
        _needless_inside(context, sent.frame, found, loc)
    for loc, delimiters in alike.items():
        _judge(context, loc, delimiters)


def _judge(context: Context, loc: Loc, judged: Sequence[tuple[Sent, Delimiter]]) -> None:
    open_ones = (item for item in judged if item[1].witness is not None)
    sent, found = next(open_ones, judged[0])
    accepted = [part.name for part in judged[0][1].parts if part.unprotected is not None]
    if found.witness is None:
        for name in accepted:
            text = f"`{name}` can't occur inside a frame, so nothing needs to be accepted"
            _needless(context, (*loc[:-1], name), text)
    elif not accepted:
        data, offset = found.witness
        source, remedy = _where(context, sent, found)
        context.error_at_key(
            "PG142",
            loc,
            f"`{loc[-1]}` can also occur inside a frame, and nothing protects it: "
            f"{data.hex(' ').upper()} has it at byte {offset}{source}",
            f"{remedy}{_protection(sent.frame)}",
        )


def _where(context: Context, sent: Sent, delimiter: Delimiter) -> tuple[str, str]:
    """Words on what can hold it, and on what keeps it out; empty where the witness says it all."""
    head, witness = sent.delimiters.head, delimiter.witness
    start = 0 if head is None or head is delimiter else len(head.words[0])
    if witness is not None and witness[1] < start:
        return ", in the start of the frame", ""
    values = frozenset(b"".join(delimiter.words))
    without = delimiters_of(sent.frame, sent.payload - values)
    same = (item for item in (without.head, without.tail) if item and item.parts == delimiter.parts)
    if not all(item.protected for item in same):
        return "", ""
    return open_payload(sent.frame, values, sent.messages, context.syntax.byte_bits)


def _protection(frame: Frame) -> str:
    """What to do about a delimiter that can occur inside."""
    accept = "or accept it: `unprotected:` and a decision's name"
    region = frame.transparency
    if region is None:
        return f"add a transparency, {accept}"
    names = [part.name for part in frame.parts]
    inside = slice(names.index(region.first), names.index(region.last) + 1)
    between = [part.name for part in frame.parts if part not in (*_ends(frame),)]
    if names[inside] == between:
        return f"let the transparency replace it, {accept}"
    return (
        f"the transparency covers no more than `{_run(region.first, region.last)}`: let it cover "
        f"all that stands between, `covers: {_run(between[0], between[-1])}`, {accept}"
    )


def _run(first: str, last: str) -> str:
    return first if first == last else f"{first}..{last}"


def _ends(frame: Frame) -> tuple[Part, ...]:
    """The first part and the last one, where they are literals."""
    ends = (frame.parts[0], frame.parts[-1])
    return tuple(part for part in ends if isinstance(part, LiteralPart | ChoicePart))


def _needless_inside(context: Context, frame: Frame, found: Delimiters, loc: Loc) -> None:
    """A literal that marks neither end needs no protection."""
    ends = [*(found.head.parts if found.head else ()), *(found.tail.parts if found.tail else ())]
    for part in frame.parts:
        accepted = isinstance(part, LiteralPart | ChoicePart) and part.unprotected is not None
        if accepted and part not in ends:
            text = f"no receiver looks for `{part.name}`, so nothing needs to be accepted"
            _needless(context, (*loc, part.name), text)


def _needless(context: Context, loc: Loc, text: str) -> None:
    context.error("PG144", (*loc, "unprotected"), text, "remove `unprotected`")
