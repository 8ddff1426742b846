"""Checksums of frames as expressions, and the statements that compare them."""

from __future__ import annotations

from contextlib import nullcontext

from protogen.model.checksums import ChecksumSpec
from protogen.model.parts import ChecksumPart, VirtualPart
from protogen.targets.python import frames as tables
from protogen.targets.python.engine import identities
from protogen.targets.python.engine.frames import EngineFrame
from protogen.targets.python.engine.layout import UNSIGNED
from protogen.targets.python.engine.lines import Constants, Lines
from protogen.targets.python.engine.numbers import FrameFunction
from protogen.targets.python.engine.place import Place
from protogen.targets.python.literals import octets_in_class, tuple_of

_SHORT = 256
"""So many bytes can be summed by Adler-32 without its modulus showing."""

FOLDED, _GREATEST_FOLDED = 32, 256
"""Bytes that are always halved until one is left, and those that are halved at all."""


class ChecksumFunction(FrameFunction):
    """Printer of a function that compares the checksums of a frame."""

    def __init__(self, frame: EngineFrame, lines: Lines) -> None:
        super().__init__(frame, lines)
        is_raw = not frame.stuffed and not self.plan.shares_delimiter and not self.plan.end_bytes
        self.content = "raw" if is_raw else "content"
        """All parts before stuffing, but not the end, nor literals in front."""
        self._in_due: tuple[ChecksumSpec, tuple[str, ...]] | None = None
        """The algorithm, and what it covers, of which the function has the result in `due`."""

    def stop_if(self, condition: str) -> None:
        """Leave it to the caller where the condition holds."""
        self.lines.add(f"if {condition}:")
        self.lines.add("    return at")

    def compare_checksums(self) -> None:
        """Compare all checksums that are there."""
        if not self.frame.checksums:
            return
        if self.plan.optional_size:
            with self.lines.block("if payload:"):
                self._compare()
        else:
            self._compare()

    def _compare(self) -> None:
        for part in self.frame.checksums:
            covered = self.covered(part)
            if part.type.within is not None:
                self._compare_bits(part, covered)
                continue
            if self.sums_to_nothing(part, covered):
                self.stop_if(f"_adler32({self.content}, 0) & 0xFF")
                continue
            first_of_xor = self.xors_to_nothing(part, covered)
            if first_of_xor is not None:
                self._fold(first_of_xor)
                continue
            if covered == self.payload_slice and not self.frame.gives_content:
                covered = "payload"
            due = checksum(part, covered, self.frame, self.lines.constants)
            first = self.frame.offset(part)
            if part.type.size in UNSIGNED and not self.has_padding(part.type):
                found = self.number_at(self.content, part, Place("", first))
                self.stop_if(f"{found} != {due}")
                continue
            found = self.frame.slice_of(self.content, first, first + part.type.size)
            self.stop_if(f"{found} != {self.lines.constants.number(part.type)}.encode({due})")

    def _compare_bits(self, part: ChecksumPart, covered: str) -> None:
        """Compare bits of a part with those of the result, which others may take bits of, too."""
        rule = part.algorithm, part.covers
        if rule != self._in_due:
            due = checksum(part, covered, self.frame, self.lines.constants)
            self.lines.add(f"due = {due}")
            self._in_due = rule
        found = self.number_at(self.content, part, Place("", self.frame.offset(part)))
        moved = f"due >> {part.lowest}" if part.lowest else "due"
        is_top = part.lowest + part.type.bits == part.algorithm.width
        mask = "" if is_top else f" & 0x{part.type.greatest:02X}"
        self.stop_if(f"{found} != {moved}{mask}")

    def covered(self, part: ChecksumPart) -> str:
        """Bytes that a checksum covers, as an expression."""
        return self.frame.covered(part, self.content, virtual=self._virtual)

    def _virtual(self, part: VirtualPart) -> str:
        """Bytes of a part that is not sent; an identity that has none is the reference's."""
        identity = [self.number(self.content, item) for item in self.plan.identity]
        return virtual_bytes(self.frame, part, identity, self.lines.constants)

    def sums_to_nothing(self, part: ChecksumPart, covered: str) -> bool:
        """True if the checksum brings the sum of the whole content to 0."""
        all_but_last = covered == self.frame.slice_of(self.content, 0, -1)
        return is_plain_sum(part, self.frame) and part.algorithm.negated and all_but_last

    def xors_to_nothing(self, part: ChecksumPart, covered: str) -> int | None:
        """Place from which the checksum brings the exclusive or of the content to 0; else None."""
        spec, runs = part.algorithm, self.frame.covered_runs(part)
        if not is_plain_xor(spec) or len(runs) != 1 or not isinstance(runs[0], tuple):
            return None
        if part.type.size != 1 or self.has_padding(part.type):
            return None
        first = runs[0][0]
        is_last = covered == self.frame.slice_of(self.content, first, -1) and first >= 0
        return first if is_last else None

    def _fold(self, first: int) -> None:
        frame = self.frame
        front = self.plan.head_size - frame.skipped - first
        greatest = front + self.plan.payload.greatest + self.plan.tail_size
        data = self.frame.slice_of(self.content, first, 0)
        are_more = f"len({self.content}) > {first + FOLDED}"
        self.stop_if(folded(self.lines, data, are_more, greatest))

    @property
    def payload_slice(self) -> str:
        """The payload within the content, as an expression."""
        frame = self.frame
        return frame.slice_of(
            self.content, self.plan.head_size - frame.skipped, -self.plan.tail_size
        )


def virtual_bytes(
    frame: EngineFrame, part: VirtualPart, identity: list[str], constants: Constants
) -> str:
    """Bytes of a part that is not sent, as an expression that fails where they are not known."""
    table = constants.named("VIRTUAL", identities.virtual_bytes(frame, part))
    key = identity[0] if len(identity) == 1 else tuple_of(identity)
    if part.default is None:
        return f"{table}[{key}]"
    return f"{table}.get({key}, {octets_in_class(part.encode(part.default))})"


def is_plain_sum(part: ChecksumPart, frame: EngineFrame) -> bool:
    """True if Adler-32 gives the sum: it is that of few bytes, modulo 256."""
    greatest = frame.plan.head_size + frame.plan.payload.greatest + frame.plan.tail_size
    spec = part.algorithm
    plain = spec.kind == "sum" and spec.is_folded_byte and spec.is_bare and not spec.init
    return plain and greatest < _SHORT


def is_plain_xor(spec: ChecksumSpec) -> bool:
    """True for the exclusive or of all bytes as it is."""
    return spec.kind == "xor" and spec.is_folded_byte and spec.is_bare and not spec.init


def folded(lines: Lines, data: str, are_more: str, greatest: int) -> str:
    """The exclusive or of at most so many bytes as an expression, worked out without a loop.

    `are_more` is the condition that there are more than `FOLDED`; empty where that is known.
    """
    if greatest > _GREATEST_FOLDED:
        return f"_checksum.xor_of({data})"
    from_bytes = lines.constants.named("FROM_BYTES", "int.from_bytes")
    lines.add(f'folded = {from_bytes}({data}, "little")')
    if greatest > FOLDED:
        with lines.block(f"if {are_more}:") if are_more else nullcontext():
            _halve(lines, greatest, (128, 64, 32))
    _halve(lines, greatest, (16, 8, 4, 2))
    return "(folded ^ folded >> 8) & 0xFF" if greatest > 1 else "folded"


def _halve(lines: Lines, greatest: int, halves: tuple[int, ...]) -> None:
    for half in halves:
        if greatest > half:
            lines.add(f"folded ^= folded >> {8 * half}")


def checksum(part: ChecksumPart, data: str, frame: EngineFrame, constants: Constants) -> str:
    """A checksum of `data` as an expression."""
    spec = part.algorithm
    if is_plain_sum(part, frame):
        total = f"_adler32({data}, 0)"
        return f"(-{total} & 0xFF)" if spec.negated else f"({total} & 0xFF)"
    if is_plain_xor(spec):
        return f"_checksum.xor_of({data})"
    function = "function()" if spec.kind == "crc" else "compute"
    compute = constants.named("CHECKSUM", f"{tables.algorithm(spec)}.{function}")
    return f"{compute}({data})"
