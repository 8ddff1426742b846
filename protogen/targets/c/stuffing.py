"""Transparency as C: how a region's bytes are taken off the wire and put on it."""

from __future__ import annotations

from dataclasses import dataclass

from protogen.model.frame import Base16, Cobs, Escape, Substitution, Transparency


@dataclass(frozen=True, slots=True)
class Code:
    """The sequence for one byte."""

    byte: int
    sequence: bytes


@dataclass(frozen=True, slots=True)
class Branch:
    """What a byte does behind the sequence's beginning that was taken so far."""

    byte: int
    node: int | None
    """The node it leads to; None where the sequence is complete."""
    value: int
    """What a complete sequence stands for."""


@dataclass(frozen=True, slots=True)
class Node:
    """A beginning of sequences. Node 0 is the empty one."""

    number: int
    beginning: bytes
    branches: tuple[Branch, ...]
    plain: bool
    """Whether any other byte stands for itself."""
    refused: tuple[int, ...]
    """Bytes that never stand for themselves, though no branch takes them."""


@dataclass(frozen=True, slots=True)
class Stuffing:
    """A region's encoding, as the templates print it."""

    kind: str
    """`codes`, `lenient_codes`, `lenient_escape`, `base16` or `cobs`."""
    lenient: bool
    reason: str
    """Why a region is refused."""
    codes: tuple[Code, ...] = ()
    nodes: tuple[Node, ...] = ()
    escape: int = 0
    escaped: tuple[int, ...] = ()
    xor: int = 0
    longest: int = 1
    """Bytes of the longest sequence."""


def stuffing_of(transparency: Transparency) -> Stuffing:
    """The encoding of a transparency."""
    lenient = transparency.lenient
    match transparency.encoding:
        case Substitution(table=table):
            return _codes(dict(table), lenient, "lenient_codes" if lenient else "codes")
        case Escape() as escape:
            escaped = {byte: bytes((escape.byte, byte ^ escape.xor)) for byte in escape.of}
            found = _codes(escaped, lenient, "lenient_escape" if lenient else "codes")
            return _with_escape(found, escape)
        case Base16():
            return Stuffing("base16", lenient, "ENCODING", longest=2)
        case Cobs():
            return Stuffing("cobs", lenient, "ENCODING")


def _with_escape(found: Stuffing, escape: Escape) -> Stuffing:
    return Stuffing(
        found.kind,
        found.lenient,
        found.reason,
        found.codes,
        found.nodes,
        escape.byte,
        tuple(sorted(escape.of)),
        escape.xor,
        2,
    )


def _codes(table: dict[int, bytes], lenient: bool, kind: str) -> Stuffing:
    codes = tuple(Code(byte, sequence) for byte, sequence in sorted(table.items()))
    return Stuffing(
        kind,
        lenient,
        "STUFFING",
        codes,
        _nodes(codes),
        longest=max((len(code.sequence) for code in codes), default=1),
    )


def _nodes(codes: tuple[Code, ...]) -> tuple[Node, ...]:
    """The tree of all sequences, breadth first."""
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
            byte = sequence[len(beginning)]
            longer = numbers.get(sequence[: len(beginning) + 1])
            branches[byte] = Branch(byte, longer, code.byte)
    listed = {code.byte for code in codes}
    refused = tuple(sorted(listed - set(branches))) if not beginning else ()
    ordered = tuple(branches[byte] for byte in sorted(branches))
    return Node(numbers[beginning], beginning, ordered, not beginning, refused)
