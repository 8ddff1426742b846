"""Frames from their parts."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import suppress
from functools import cached_property
from itertools import groupby
from typing import Any, Self

from protogen.runtime.attributes import argument
from protogen.runtime.errors import EncodeError
from protogen.runtime.framing.frame import (
    BitsPart,
    ChecksumPart,
    CounterPart,
    LengthPart,
    LiteralPart,
    NumberPart,
    Part,
    PayloadPart,
    ValuePart,
)
from protogen.runtime.framing.layout import Layout, is_optional
from protogen.runtime.framing.machine import Cut, verdict_on
from protogen.runtime.framing.sender import SenderSpec
from protogen.runtime.identities import Identity
from protogen.runtime.payload.number import Characters, GivenValue, given_number


def encode_frame(
    sender: SenderSpec[Any, Any],
    identity: Identity,
    payload: bytes,
    given: Mapping[str, GivenValue],
    strict: bool = True,
) -> bytes:
    """The frame that carries `payload`.

    `given` holds the values of counters and other value parts by name; None is the same as not
    given. Raises EncodeError where a value is missing or out of range, where the payload does not
    fit the frame, and where a decoder would end the frame elsewhere.
    """
    layout = sender.layout
    numbers = _value_parts(layout, given, strict)
    numbers |= {part.name: value for part, value in zip(layout.identity, identity, strict=True)}
    wire = _Assembly(layout, numbers, payload, sender.virtual(numbers)).wire()
    if sender.frame.is_bounded and len(wire) > sender.frame.greatest:
        problem = f"makes a frame of {len(wire)} bytes, at most {sender.frame.greatest} are allowed"
        raise EncodeError("payload", problem)
    if sender.frame.ambiguous_cut or sender.group(identity) is None:
        check_cut(sender, wire, payload, numbers)
    return wire


def first_that_fits(
    senders: Sequence[SenderSpec[Any, Any]], encode: Callable[[SenderSpec[Any, Any]], bytes]
) -> bytes:
    """The frame in the first form that can be made. Raises the EncodeError of the last."""
    for sender in senders[:-1]:
        with suppress(EncodeError):
            return encode(sender)
    return encode(senders[-1])


def join_parts(
    sender: SenderSpec[Any, Any],
    payload: bytes,
    numbers: Mapping[str, int],
    bytes_of: Mapping[str, bytes],
) -> bytes:
    """The wire bytes of parts as somebody printed them, right or wrong.

    `bytes_of` gives the bytes of some parts; what is left is made from `numbers` and `payload`.
    """
    assembly = _Assembly(sender.layout, numbers, payload, sender.virtual(numbers))
    return assembly.with_bytes(bytes_of).joined()


def check_cut(
    sender: SenderSpec[Any, Any], wire: bytes, payload: bytes, numbers: Mapping[str, int]
) -> None:
    """Raise EncodeError unless a decoder takes exactly these bytes for the frame.

    `numbers` has the values of parts, identities that the decoder is told among them.
    """
    told = {**numbers, **sender.layout.told_size(len(payload))}
    verdict, _ = verdict_on(sender, wire, told=told)
    if verdict.size < len(wire):
        problem = f"a decoder would end the frame behind {verdict.size} of its {len(wire)} bytes"
        raise EncodeError("payload", problem)
    if not isinstance(verdict, Cut) or verdict.payload != payload:
        raise EncodeError("payload", "a decoder would not find it in the frame")


def _value_parts(layout: Layout, given: Mapping[str, GivenValue], strict: bool) -> dict[str, int]:
    known = {part.name: part for part in layout.values}
    for name, value in given.items():
        if name not in known and value is not None:
            raise EncodeError(name, f"there is no such part; there are: {_names(known)}")
    return {
        name: _part_value(part, given.get(name), strict or part in layout.bounded)
        for name, part in known.items()
    }


def _names(names: Iterable[str]) -> str:
    return ", ".join(names) or "none"


def _part_value(part: ValuePart, given: GivenValue, strict: bool) -> int:
    value: Any = part.default if given is None else given
    if value is None:
        raise EncodeError(part.name, _how_to_give(part))
    try:
        number = value if given is None else given_number(part.number, value)
    except EncodeError as error:
        raise error.inside(part.name) from None
    if strict and isinstance(given, str) and not given.isascii():
        raise EncodeError(part.name, f"{given!r} has a character that is not ASCII")
    if strict and not part.holds(number):
        shown = repr(given) if isinstance(given, str) and not part.values else number
        raise EncodeError(part.name, f"{shown} is not {part.allowed}")
    return number


def _how_to_give(part: ValuePart) -> str:
    value = "TEXT" if isinstance(part.number, Characters) else part.least
    example = f"encode(..., {argument(part.name)}={value})"
    if isinstance(part, CounterPart):
        return f"the value is missing; give it as in {example}, or use an Encoder, which counts"
    return f"the value is missing; give it as in {example}"


class _Assembly:
    """The bytes of one frame's parts."""

    def __init__(
        self,
        layout: Layout,
        numbers: Mapping[str, int],
        payload: bytes,
        virtual: Mapping[str, bytes],
    ) -> None:
        """`virtual` has the bytes of parts that are not sent, where they have a value."""
        self._layout = layout
        self._virtual = virtual
        self._numbers = numbers
        self._payload = payload
        self._parts = {
            part.name: part for part in layout.spec.parts if payload or not is_optional(part)
        }
        self._pieces: dict[str, bytes] = {}

    def wire(self) -> bytes:
        """The frame on the wire."""
        self._check_payload()
        return self.joined()

    def joined(self) -> bytes:
        """All parts on the wire, whatever they hold."""
        return self._on_wire(self._parts)

    def with_bytes(self, bytes_of: Mapping[str, bytes]) -> Self:
        """The same frame, where these parts have these bytes before any stuffing."""
        self._pieces.update(bytes_of)
        return self

    def _check_payload(self) -> None:
        greatest = self._layout.spec.greatest_payload
        # Without a length, a message's own size bounds its payload, and the frame's an unknown one.
        is_bounded = self._layout.length is not None or self._layout.spec.is_bounded
        if is_bounded and len(self._payload) > greatest:
            problem = f"has {len(self._payload)} bytes, at most {greatest} fit the frame"
            raise EncodeError("payload", problem)
        if self._layout.spec.seven_bit and not self._payload.isascii():
            raise EncodeError("payload", "a byte has its most significant bit set")
        if self._layout.told_length is not None:
            self._length(self._layout.told_length)

    def _on_wire(self, names: Iterable[str]) -> bytes:
        """These parts, those under transparency encoded."""
        wire = b""
        for stuffed, run in groupby(names, key=self._layout.spec.stuffed.__contains__):
            joined = self._content(run)
            transparency = self._layout.spec.transparency
            wire += transparency.encode(joined) if stuffed and transparency else joined
        return wire

    def _content(self, names: Iterable[str]) -> bytes:
        return b"".join(map(self._piece, names))

    def _piece(self, name: str) -> bytes:
        """One part before stuffing. Checksums are worked out when what they cover is known."""
        if name in self._virtual:
            return self._virtual[name]
        if name not in self._pieces:
            self._pieces[name] = self._make(self._parts[name])
        return self._pieces[name]

    def _make(self, part: Part) -> bytes:
        if isinstance(part, LiteralPart):
            return part.value
        if isinstance(part, PayloadPart):
            return self._payload
        if isinstance(part, BitsPart):
            sums = {item.name: item.due(self._checksum(item)) for item in part.sums}
            return part.encode({**self._known, **sums})
        return self._number(part, self._value(part))

    @cached_property
    def _known(self) -> Mapping[str, int]:
        """The numbers from which bits follow: those that are given, and lengths."""
        lengths = [part for part in self._layout.lengths if not part.over_wire]
        return {**self._numbers, **{part.name: self._length(part) for part in lengths}}

    def _value(self, part: NumberPart) -> int:
        if isinstance(part, ChecksumPart):
            return self._checksum(part)
        if isinstance(part, LengthPart):
            return self._length(part)
        return self._numbers[part.name]

    def _checksum(self, part: ChecksumPart) -> int:
        known = self._parts.keys() | self._virtual.keys()
        for virtual in self._layout.spec.virtual:
            if virtual.name in part.covers and virtual.name not in known:
                problem = f"has no value for an unknown identity, and {part.name} covers it"
                raise EncodeError(virtual.name, problem)
        covered = [name for name in part.covers if name in known]
        data = self._on_wire(covered) if part.over_wire else self._content(covered)
        return part.algorithm.compute(data)

    def _length(self, part: LengthPart) -> int:
        value = self._layout.counted(part, len(self._payload))
        if part.over_wire:
            stuffed = [name for name in self._parts if name in self._layout.spec.stuffed]
            value += len(self._on_wire(stuffed)) - len(self._content(stuffed))
        if not part.least <= value <= part.greatest:
            problem = f"makes {part.name} {value}, which is not in {part.least}..{part.greatest}"
            raise EncodeError("payload", problem)
        return value

    @staticmethod
    def _number(part: NumberPart, value: int) -> bytes:
        try:
            return part.number.encode(value)
        except ValueError as error:
            raise EncodeError(part.name, str(error)) from None
