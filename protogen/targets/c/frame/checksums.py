"""Checksum parts, as a receiver verifies them and a sender fills them."""

from __future__ import annotations

import msgspec

from protogen.copying import replace
from protogen.model.checksums import ChecksumSpec, find_algorithm
from protogen.model.frame_places import Run, Side
from protogen.model.frame_plan import FramePlan
from protogen.model.part_plans import ChecksumPlan
from protogen.model.parts import ChecksumPart, VirtualPart
from protogen.targets.c.frame.algorithms import Algorithm, algorithm_of
from protogen.targets.c.frame.expressions import Index, constant_of, differs, taken_bits
from protogen.targets.c.frame.part_numbers import PartNumbers, fills_bytes
from protogen.targets.c.frame.virtual import VirtualView


class CoveredRun(msgspec.Struct, frozen=True):
    """A run of content that a checksum covers."""

    first: Index
    last: Index
    stuffed: bool
    """True if it is stuffed on the wire, and the checksum covers what is there."""
    literal: bytes = b""
    virtual: None = None

    def size(self, payload: int) -> int:
        """Bytes of the run in a frame with such a payload."""
        return self.last.at(payload) - self.first.at(payload)

    def of(self, payload: str) -> str:
        """Start and size of the run, where `payload` is the C of the payload's size."""
        known = constant_of(payload)
        if known is not None:
            return f"&content[{self.first.at(known)}], {self.size(known)}U"
        wide = payload if payload == "payload" else f"(size_t){payload}"  # That is a size_t.
        first, last = self.first.of(wide), self.last.of(wide)
        if first == "0U":
            return f"content, {last}"
        if self.last.place.side is Side.HEAD:
            return f"&content[{first}], {self.last.place.offset - self.first.place.offset}U"
        return f"&content[{first}], {last} - {f'({first})' if ' ' in first else first}"


class CoveredLiteral(msgspec.Struct, frozen=True):
    """A literal of the end that a checksum covers."""

    literal: bytes
    stuffed: bool = False
    virtual: None = None


class CoveredVirtual(msgspec.Struct, frozen=True):
    """A part that a checksum covers and that is not sent."""

    virtual: VirtualView
    stuffed: bool = False
    literal: bytes = b""


class ChecksumView(msgspec.Struct, frozen=True):
    """A checksum part."""

    part: ChecksumPart
    checksum: Algorithm
    numbers: PartNumbers
    covers: tuple[CoveredRun | CoveredLiteral | CoveredVirtual, ...]
    at: Index
    """Place of its first byte in the content."""
    optional: bool
    over_wire: bool
    sums_stuffed: bool
    """True if some of what it covers is stuffed on the wire before it is summed."""

    @property
    def name(self) -> str:
        """The name in the schema."""
        return self.part.name

    @property
    def is_bits(self) -> bool:
        """True if it is bits of a part."""
        return self.part.type.within is not None

    @property
    def covered(self) -> tuple[str, ...]:
        """The names of the parts that it covers and that are not sent."""
        return tuple(item.virtual.name for item in self.covers if item.virtual is not None)

    @property
    def size(self) -> int:
        """Bytes of content."""
        return self.part.type.size

    def wire_bytes(self, value: str) -> tuple[str, ...]:
        """The bytes of a result in wire order."""
        return self.numbers.bytes_of(self.part.type, value)

    def adds_bytes_up_to(self, most: int, payload: int) -> bool:
        """True if it is a sum, or an exclusive or, of no more bytes than that, and is a byte."""
        if self.checksum.spec.kind not in ("xor", "sum") or self.size != 1 or self.is_bits:
            return False
        runs = [item for item in self.covers if isinstance(item, CoveredRun)]
        return len(runs) == len(self.covers) and sum(run.size(payload) for run in runs) <= most

    @property
    def cancels(self) -> bool:
        """True if the result over what it covers and itself is 0, and it stands right behind that.

        One comparison with 0 is shorter than one with a byte that has to be found.
        """
        spec, covers = self.checksum.spec, self.covers
        if not spec.is_folded_byte or not spec.is_bare or spec.negated != (spec.kind == "sum"):
            return False
        if self.over_wire or self.sums_stuffed or len(covers) != 1 or not fills_bytes(self.part):
            return False
        run = covers[0]
        return isinstance(run, CoveredRun) and self.size == 1 and run.last == self.at

    def verified(self, run: CoveredRun) -> CoveredRun:
        """The run that a receiver sums up: with the checksum, where that leaves 0."""
        if not self.cancels:
            return run
        place = replace(self.at.place, offset=self.at.place.offset + 1)
        return replace(run, last=replace(self.at, place=place))

    def differs(self, payload: str) -> str:
        """The condition that `content` has another number than `due`, or other bytes or bits."""
        if self.cancels:
            return "due != 0U"
        if self.is_bits:
            found = self.numbers.bits(self.part.type, "content", self.at.of(payload))
            return f"{found} != {taken_bits(self.part, 'due')}"
        if fills_bytes(self.part):
            return f"{self.numbers.whole(self.part.type, 'content', self.at.of(payload))} != due"
        at = self.at.of(payload)
        known = constant_of(at)
        return differs(self.wire_bytes("due"), "content", at if known is None else known)


def checksums_of(
    plan: FramePlan, protocol: str, numbers: PartNumbers, virtual: tuple[VirtualView, ...]
) -> tuple[ChecksumView, ...]:
    """The views of a frame's checksums."""
    return tuple(_checksum(plan, item, protocol, numbers, virtual) for item in plan.checksums)


def _checksum(
    plan: FramePlan,
    item: ChecksumPlan,
    protocol: str,
    numbers: PartNumbers,
    virtual: tuple[VirtualView, ...],
) -> ChecksumView:
    part = item.part
    return ChecksumView(
        part=part,
        checksum=algorithm_of(part.algorithm, checksum_name(protocol, part.algorithm)),
        numbers=numbers,
        covers=tuple(_covered(plan, cover, virtual) for cover in item.covers),
        at=Index(item.placed.place, plan.head_size),
        optional=part.when_payload,
        over_wire=part.over_wire,
        sums_stuffed=item.over_stuffing,
    )


def _covered(
    plan: FramePlan, cover: Run | bytes | VirtualPart, virtual: tuple[VirtualView, ...]
) -> CoveredRun | CoveredLiteral | CoveredVirtual:
    match cover:
        case Run():
            first, last = Index(cover.first, plan.head_size), Index(cover.end, plan.head_size)
            return CoveredRun(first, last, cover.over_stuffing)
        case VirtualPart():
            return CoveredVirtual(next(view for view in virtual if view.part == cover))
        case bytes():
            return CoveredLiteral(cover)


def checksum_name(protocol: str, spec: ChecksumSpec) -> str:
    """The name of the C function of an algorithm."""
    name = spec.name
    if find_algorithm(name) != spec:  # The schema gives the parameters.
        name = _by_parameters(spec)
    letters = "".join(c if c.isalnum() else "_" for c in name.lower())
    return f"{protocol}_{letters}".replace("__", "_")


def _by_parameters(spec: ChecksumSpec) -> str:
    if spec.kind == "crc":
        order = f"{'r' if spec.refin else 'n'}{'r' if spec.refout else 'n'}"
        return f"crc_{spec.width}_{spec.poly:x}_{spec.init:x}_{order}_{spec.xorout:x}"
    numbers = f"{spec.kind}_{spec.width}_{spec.init:x}"
    sign = "n" if spec.negated else "p"
    mask = "" if spec.mask is None else f"{spec.mask:x}"
    return f"{numbers}_{sign}_{spec.xorout:x}_{mask}_{spec.add:x}_{spec.words or 'bytes'}"
