"""How many bytes does a frame take on the wire, stuffing included?"""

from __future__ import annotations

from protogen.model.frame import Base16, Cobs, Escape, Frame, IdentityPart, Part, PayloadPart
from protogen.model.messages import Message
from protogen.model.sizes import SizeSet
from protogen.passes.capacity import is_optional, part_size, tail_literals
from protogen.passes.wire_code import ByteSet, code_of, covered_parts, part_bytes

_COBS_BLOCK = 254


class WireSizes:
    """Sizes of one sender's frames. Bounds: stuffing is counted byte by byte at its worst."""

    def __init__(self, frame: Frame, payload: ByteSet) -> None:
        self._frame = frame
        self._payload = payload
        self._covered = covered_parts(frame)
        self._encoding = frame.transparency.encoding if frame.transparency else None
        self._known: dict[str, tuple[int, int]] = {}

    @property
    def head(self) -> int:
        """Unstuffed bytes in front of the payload."""
        return sum(part_size(part) for part in self._around()[0])

    @property
    def tail(self) -> int:
        """Unstuffed bytes behind the payload but for the end literal."""
        ends = {part.name for part in tail_literals(self._frame)}
        return sum(part_size(part) for part in self._around()[1] if part.name not in ends)

    @property
    def overhead(self) -> SizeSet:
        """Bytes that are not payload, before stuffing."""
        fixed = sum(part_size(part) for part in self._frame.parts)
        optional = sum(part_size(part) for part in self._frame.checksums if part.when_payload)
        return SizeSet.between(fixed - optional, fixed, optional)

    def frame(self, payload: SizeSet) -> SizeSet:
        """Wire bytes of any frame with such a payload."""
        return self._sizes(payload, {})

    def message(self, message: Message, payload: SizeSet) -> SizeSet:
        """Wire bytes of the frames of one message, whose identity is known."""
        names = [part.name for part in self._frame.identity]
        return self._sizes(payload, dict(zip(names, message.identity, strict=True)))

    def _around(self) -> tuple[list[Part], list[Part]]:
        parts = list(self._frame.parts)
        middle = next(i for i, part in enumerate(parts) if isinstance(part, PayloadPart))
        return parts[:middle], parts[middle + 1 :]

    def _sizes(self, payload: SizeSet, identity: dict[str, int]) -> SizeSet:
        least = self._total(payload.least, identity, worst=False)
        greatest = self._total(payload.greatest, identity, worst=True)
        exact = self._encoding is None or isinstance(self._encoding, Base16)
        step = payload.step * (2 if self._encoding and exact else 1) if exact else 1
        optional = any(part.when_payload for part in self._frame.checksums)
        return SizeSet.between(least, greatest, 1 if optional else step)

    def _total(self, payload: int, identity: dict[str, int], *, worst: bool) -> int:
        present = [part for part in self._frame.parts if payload or not is_optional(part)]
        raw = [part for part in present if part.name not in self._covered]
        covered = [part for part in present if part.name in self._covered]
        size = sum(payload if isinstance(part, PayloadPart) else part_size(part) for part in raw)
        if not covered:
            return size
        if isinstance(self._encoding, Cobs):
            inside = sum(
                payload if isinstance(part, PayloadPart) else part_size(part) for part in covered
            )
            return size + inside + self._cobs_codes(inside, worst=worst)
        return size + sum(self._stuffed(part, payload, identity, worst=worst) for part in covered)

    def _cobs_codes(self, inside: int, *, worst: bool) -> int:
        """Code bytes. Where no data are, a lenient decoder takes none; and one that is needless."""
        assert self._frame.transparency is not None
        lenient = self._frame.transparency.lenient
        if not worst:
            return 0 if lenient and not inside else 1
        return 1 + inside // _COBS_BLOCK if lenient else max(1, -(-inside // _COBS_BLOCK))

    def _stuffed(self, part: Part, payload: int, identity: dict[str, int], *, worst: bool) -> int:
        """Wire bytes of a covered part: the shortest or longest codewords of what it can hold."""
        if isinstance(part, IdentityPart) and part.name in identity:
            alone = (frozenset({byte}) for byte in _bytes_of(part, identity[part.name]))
            return sum(self._codeword(values, worst=worst) for values in alone)
        size = self._codewords(part.name)[worst]
        return size * payload if isinstance(part, PayloadPart) else size

    def _codewords(self, name: str) -> tuple[int, int]:
        """Wire bytes of a part (of one byte of the payload), at best and at worst."""
        if name not in self._known:
            places = part_bytes(self._frame.part(name), self._payload)
            self._known[name] = (
                sum(self._codeword(values, worst=False) for values in places),
                sum(self._codeword(values, worst=True) for values in places),
            )
        return self._known[name]

    def _codeword(self, values: ByteSet, *, worst: bool) -> int:
        """Wire bytes of one byte that has one of these values."""
        code = code_of(self._encoding)
        assert code is not None
        if not worst:
            return min(len(code[value]) for value in values)
        return self._needless or max(len(code[value]) for value in values)

    @property
    def _needless(self) -> int:
        """Bytes that an escape takes, where a lenient decoder accepts one in front of any byte."""
        lenient = self._frame.transparency is not None and self._frame.transparency.lenient
        return 2 if lenient and isinstance(self._encoding, Escape) else 0


def _bytes_of(part: IdentityPart, value: int) -> list[int]:
    """The unstuffed bytes of a value, in any order."""
    bits, size = part.type.byte_bits, part.type.size
    return [(value >> (bits * place)) & ((1 << bits) - 1) for place in range(size)]
