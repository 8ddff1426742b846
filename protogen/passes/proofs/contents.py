"""Contents of a frame, where its message and the size of its payload are known."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from itertools import groupby

import msgspec

from protogen.model.checksums import checksum_of
from protogen.model.constants import constant_bytes
from protogen.model.frame import Frame
from protogen.model.parts import BitsPart, ChecksumPart, LengthPart, NumberPart, Part, PayloadPart
from protogen.model.transparency import Insertion
from protogen.model.types import Field
from protogen.passes.framing.capacity import counted_size
from protogen.passes.proofs.wire_code import ByteSet, bits_bytes, code_of, part_bytes


class Stretch(msgspec.Struct, frozen=True):
    """So many bytes in a row, each of which is one of `values`."""

    values: ByteSet
    count: int = 1

    @property
    def known(self) -> bool:
        """True if the bytes are always the same."""
        return len(self.values) == 1


Contents = Mapping[str, tuple[Stretch, ...]]
"""The bytes of each part that is present."""


def contents_of(
    frame: Frame, payload: tuple[Stretch, ...], identity: Mapping[str, int]
) -> Contents:
    """The bytes of frames with this payload and, as far as it is known, this identity."""
    size = sum(stretch.count for stretch in payload)
    known = dict(identity)
    for length in frame.lengths:
        stated = None if length.over_wire else _stated(frame, length, size)
        if stated is not None:
            known[length.name] = stated
    found: dict[str, tuple[Stretch, ...]] = {}
    for part in frame.parts:
        if size or not part.is_optional:
            found[part.name] = _part(part, payload, known)
    for checksum in frame.checksums:
        _settle(frame, checksum, found)
    return found


def payload_of(fields: Sequence[Field], size: int, values: ByteSet) -> tuple[Stretch, ...]:
    """A payload of these fields, of so many bytes: constants are known, other bytes are not."""
    varying = [field for field in fields if field.size is None]
    fixed = sum(field.size or 0 for field in fields)
    if len(varying) > 1 or fixed > size or (not varying and fixed < size):
        return (Stretch(values, size),)
    stretches = (_field(field, size - fixed, values) for field in fields)
    return tuple(stretch for found in stretches for stretch in found if stretch.count)


def _field(field: Field, rest: int, values: ByteSet) -> tuple[Stretch, ...]:
    """The bytes of one field; `rest` is the size of the one whose size varies."""
    if field.constant_number is not None:
        return known_bytes(constant_bytes(field))
    return (Stretch(values, rest if field.size is None else field.size),)


def _part(
    part: Part, payload: tuple[Stretch, ...], known: Mapping[str, int]
) -> tuple[Stretch, ...]:
    """The bytes of a part; `known` has the values of numbers that are always the same."""
    if isinstance(part, PayloadPart):
        return payload
    value = known.get(part.name)
    if isinstance(part, BitsPart):
        return tuple(Stretch(values) for values in bits_bytes(part, known))
    if isinstance(part, NumberPart) and value is not None:
        return known_bytes(part.encode(value))
    return tuple(Stretch(values) for values in part_bytes(part, frozenset()))


def _stated(frame: Frame, length: LengthPart, payload: int) -> int | None:
    """Value of the length part; None where it can't say that, so that there is no such frame."""
    value = payload + counted_size(frame, length, empty=not payload)
    return value if length.least <= value <= length.greatest else None


def _settle(frame: Frame, part: ChecksumPart, found: dict[str, tuple[Stretch, ...]]) -> None:
    """A checksum of bytes that are always the same is always the same."""
    if part.name not in found or all(stretch.known for stretch in found[part.name]):
        return
    covering = [item for item in frame.checksums if item.name in part.covers]
    for other in covering:
        _settle(frame, other, found)
    if has_virtual(frame, part):
        return
    covered = [stretch for name in part.covers for stretch in found.get(name, ())]
    if all(stretch.known for stretch in covered):
        plain = {name: _plain(found[name]) for name in part.covers if name in found}
        found[part.name] = known_bytes(checksum_bytes(frame, part, plain))


def has_virtual(frame: Frame, part: ChecksumPart) -> bool:
    """True if a checksum covers what is not sent: another value for each message."""
    return any(item.name in part.covers for item in frame.virtual)


def _plain(stretches: Iterable[Stretch]) -> bytes:
    return b"".join(bytes(stretch.values) * stretch.count for stretch in stretches)


def known_bytes(data: bytes) -> tuple[Stretch, ...]:
    """Bytes that are always the same."""
    return tuple(Stretch(frozenset({byte})) for byte in data)


def checksum_bytes(frame: Frame, part: ChecksumPart, plain: Mapping[str, bytes]) -> bytes:
    """The unstuffed bytes of a checksum over these contents of parts."""
    present = [name for name in part.covers if name in plain]
    covered = b"".join(plain[name] for name in present)
    if part.over_wire:
        runs = groupby(present, key=frame.stuffed.__contains__)
        covered = b"".join(
            _on_wire(frame, b"".join(plain[name] for name in run), stuffed=stuffed)
            for stuffed, run in runs
        )
    return number_bytes(part, checksum_of(part.algorithm).compute(covered))


def put_checksum(frame: Frame, part: ChecksumPart, plain: dict[str, bytes]) -> None:
    """Let these contents of parts have the right checksum."""
    due = checksum_bytes(frame, part, plain)
    if part.type.within is None:
        plain[part.name] = due
        return
    holder = frame.holder(part.name).name
    own = part.encode(part.type.greatest)
    bits = zip(plain[holder], own, due, strict=True)
    plain[holder] = bytes(byte & ~mask | value for byte, mask, value in bits)


def has_checksum(frame: Frame, part: ChecksumPart, plain: Mapping[str, bytes]) -> bool:
    """True if these contents of parts have the right checksum."""
    right = dict(plain)
    put_checksum(frame, part, right)
    return right == plain


def number_bytes(part: ChecksumPart, value: int) -> bytes:
    """The unstuffed bytes of a checksum; one that stands in for another may be too wide."""
    return part.encode(part.due(value) & part.type.greatest)


def _on_wire(frame: Frame, plain: bytes, *, stuffed: bool) -> bytes:
    """The bytes of parts as an encoder stuffs them; COBS was refused for such checksums."""
    code = code_of(frame.encoding)
    if code is None or not stuffed:
        return plain
    if isinstance(frame.encoding, Insertion):
        word = frame.encoding.sequence
        return plain.replace(word, word + bytes((frame.encoding.byte,)))
    return b"".join(code[byte] for byte in plain)
