"""Transparency as C: how a region's bytes are taken off the wire and put on it."""

from __future__ import annotations

from enum import Enum, auto

import msgspec

from protogen.model.part_plans import StuffedRegion
from protogen.model.transparency import Base16, Cobs, Escape, Insertion, Substitution
from protogen.runtime.transparency.insertion import followed
from protogen.targets.c.frame.expressions import byte


class StuffingKind(Enum):
    """Ways to take a region off the wire. A template is named after each."""

    CODES = auto()
    """A sequence for each byte that does not stand for itself, and no other sequences."""
    LENIENT_CODES = auto()
    """A sequence that no byte has stands for itself."""
    LENIENT_ESCAPE = auto()
    """Any byte may stand behind the escape."""
    INSERTION = auto()
    """A byte stands behind each sequence of some others."""
    BASE16 = auto()
    COBS = auto()

    @property
    def word(self) -> str:
        """Its name, as templates have it."""
        return self.name.lower()


class Code(msgspec.Struct, frozen=True):
    """The sequence for one byte."""

    byte: int
    sequence: bytes


class Branch(msgspec.Struct, frozen=True):
    """Effect of a byte behind the beginning of a sequence."""

    byte: int
    node: int | None
    """The node it leads to; None where the sequence is complete."""
    value: int
    """Byte that a complete sequence stands for."""


class Node(msgspec.Struct, frozen=True):
    """A beginning of sequences. Node 0 is the empty one."""

    number: int
    beginning: bytes
    branches: tuple[Branch, ...]
    plain: bool
    """True if any other byte stands for itself."""
    refused: tuple[int, ...]
    """Bytes that never stand for themselves, though no branch takes them."""


class Stuffing(msgspec.Struct, frozen=True):
    """A region's encoding, as the templates print it."""

    kind: StuffingKind
    lenient: bool
    codes: tuple[Code, ...]
    nodes: tuple[Node, ...]
    longest: int
    """Bytes of the longest sequence."""
    sequence: bytes = b""
    """What a byte is put in behind."""
    inserted: int = 0
    following: tuple[dict[int, int], ...] = ()
    """How much of that is there behind so much of it and a byte; nothing for those left out."""
    escape: int = 0
    escaped: tuple[int, ...] = ()
    xor: int = 0

    @property
    def is_cobs(self) -> bool:
        """True if the bytes that follow decide what a byte is on the wire."""
        return self.kind is StuffingKind.COBS

    @property
    def inserts(self) -> bool:
        """True if the bytes in front decide what a byte is on the wire."""
        return self.kind is StuffingKind.INSERTION

    @property
    def is_whole(self) -> str:
        """The value of `node` where nothing of a sequence is held, as a comparison."""
        return f"!= {len(self.sequence)}U" if self.inserts else "== 0U"

    @property
    def reason(self) -> str:
        """Reason why a region is refused."""
        is_encoding = self.kind in (StuffingKind.BASE16, StuffingKind.COBS)
        return "ENCODING" if is_encoding else "STUFFING"

    @property
    def is_escaped(self) -> str:
        """The condition that an escape stands in front of `byte`."""
        return " || ".join(f"byte == {byte(value)}" for value in self.escaped)


def stuffing_of(region: StuffedRegion | None) -> Stuffing | None:
    """The encoding of a region, where there is one."""
    if region is None:
        return None
    codes = tuple(Code(value, sequence) for value, sequence in region.codes)
    escape = region.escape
    return Stuffing(
        kind=_kind(region),
        lenient=region.lenient,
        codes=codes,
        nodes=_nodes(codes),
        longest=2 if region.insertion else region.longest,
        sequence=region.insertion.sequence if region.insertion else b"",
        inserted=region.insertion.byte if region.insertion else 0,
        following=followed(region.insertion.sequence) if region.insertion else (),
        escape=escape.byte if escape else 0,
        escaped=tuple(sorted(escape.of)) if escape else (),
        xor=escape.xor if escape else 0,
    )


def _kind(region: StuffedRegion) -> StuffingKind:
    match region.encoding:
        case Base16():
            return StuffingKind.BASE16
        case Insertion():
            return StuffingKind.INSERTION
        case Cobs():
            return StuffingKind.COBS
        case Escape() if region.lenient:
            return StuffingKind.LENIENT_ESCAPE
        case Substitution() if region.lenient:
            return StuffingKind.LENIENT_CODES
    return StuffingKind.CODES


def _nodes(codes: tuple[Code, ...]) -> tuple[Node, ...]:
    """The tree of all sequences, breadth first."""
    if not codes:
        return ()
    beginnings = [b""]
    for code in codes:
        for size in range(1, len(code.sequence)):
            if code.sequence[:size] not in beginnings:
                beginnings.append(code.sequence[:size])
    beginnings.sort(key=lambda item: (len(item), item))
    numbers = {item: number for number, item in enumerate(beginnings)}
    return tuple(_node(item, numbers, codes) for item in beginnings)


def _node(beginning: bytes, numbers: dict[bytes, int], codes: tuple[Code, ...]) -> Node:
    branches = {}
    for code in codes:
        sequence = code.sequence
        if sequence.startswith(beginning) and len(sequence) > len(beginning):
            follower = sequence[len(beginning)]
            longer = numbers.get(sequence[: len(beginning) + 1])
            branches[follower] = Branch(follower, longer, code.byte)
    listed = {code.byte for code in codes}
    refused = tuple(sorted(listed - set(branches))) if not beginning else ()
    ordered = tuple(branches[follower] for follower in sorted(branches))
    return Node(numbers[beginning], beginning, ordered, not beginning, refused)
