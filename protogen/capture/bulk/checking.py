"""Which contents are those of whole frames, and what their parts are."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from protogen.capture.arrays import numpy
from protogen.capture.bulk.contents import Contents
from protogen.capture.bulk.numbers import integers
from protogen.capture.bulk.places import stands, windows
from protogen.model.frame import ChecksumPart, LiteralPart
from protogen.runtime.checksum import Checksum
from protogen.targets.python.fast.frames import FastFrame

if TYPE_CHECKING:
    from protogen.capture.tables import Rows
    from protogen.model.types import Integer


@dataclass(frozen=True, slots=True)
class Framed:
    """Frames that are in order but for their payloads, which nobody has looked at yet."""

    contents: Contents
    numbers: dict[str, Rows]
    """The values of the parts that events show, by name."""
    payload_at: Rows
    """Where payloads begin in the contents' bytes."""
    payload_size: Rows


def framed(
    frame: FastFrame, checksums: Mapping[str, Checksum], octets: Rows, contents: Contents
) -> Framed:
    """The frames that are in order.

    `checksums`: those of the parts, as the runtime has them. `octets`: the bytes on the wire.
    """
    contents = contents.only(_fits(frame, contents))
    for literal in frame.head:
        if isinstance(literal, LiteralPart) and not frame.is_start(literal):
            contents = contents.only(_has_literal(frame, literal, octets, contents))
    if frame.length is not None:
        contents = contents.only(_has_length(frame, contents))
    for part in frame.checksums:
        contents = contents.only(_has_checksum(frame, part, checksums[part.name], contents))
    numbers, right = {}, None
    for shown in frame.shown:
        values, wrong = _number(contents, frame.offset(shown), shown.type)
        numbers[shown.name] = values
        if wrong is not None:
            right = ~wrong if right is None else right & ~wrong
    if right is not None:
        contents = contents.only(right)
        numbers = {name: values[right] for name, values in numbers.items()}
    return Framed(
        contents,
        numbers,
        contents.at + (frame.head_size - frame.skipped),
        _payload_sizes(frame, contents),
    )


# --- sizes ----------------------------------------------------------------------------------------


def _around(frame: FastFrame) -> int:
    """Bytes of the content that are not the payload's."""
    return frame.head_size - frame.skipped + frame.tail_size


def _fits(frame: FastFrame, contents: Contents) -> Rows:
    """Where all parts are there."""
    size, around = contents.size, _around(frame)
    if frame.optional:
        return (size == around - frame.optional_size) | (size > around)  # type: ignore[no-any-return]
    return size >= max(around, 1)


def _payload_sizes(frame: FastFrame, contents: Contents) -> Rows:
    """The payloads' sizes; optional checksums are absent where that is 0."""
    sizes: Rows = contents.size - _around(frame)
    return sizes.clip(0) if frame.optional else sizes


def _has_length(frame: FastFrame, contents: Contents) -> Rows:
    """Where the length is right and in its bounds."""
    part = frame.length
    assert part is not None
    values, wrong = _number(contents, frame.offset(part), part.type)
    # What is too great for 63 bits becomes negative.
    number, payload = values.astype("i8"), _payload_sizes(frame, contents)
    due = payload + frame.counted(part)
    if frame.optional:
        due = due - frame.counted_optional(part) * (payload == 0)
    found: Rows = (number == due) & (number >= part.least) & (number <= part.greatest)
    found &= payload <= frame.framing.payload.greatest
    return found if wrong is None else found & ~wrong


# --- values ---------------------------------------------------------------------------------------


def _number(contents: Contents, offset: int, type_: Integer) -> tuple[Rows, Rows | None]:
    """A part; an offset below 0 is counted from the content's end."""
    first = contents.at + offset
    if offset < 0:
        first = first + contents.size
    return integers(windows(contents.octets, first, type_.size), type_)


def _has_literal(frame: FastFrame, part: LiteralPart, octets: Rows, contents: Contents) -> Rows:
    """Where a literal of the head stands."""
    offset = frame.offset(part)
    if frame.is_skipped(part):
        return stands(octets, contents.frames.at + offset + frame.skipped, part.bytes)
    return stands(contents.octets, contents.at + offset, part.bytes)


def _has_checksum(
    frame: FastFrame, part: ChecksumPart, checksum: Checksum, contents: Contents
) -> Rows:
    """Where the checksum is right, or absent."""
    if frame.optional:
        holds = _payload_sizes(frame, contents) > 0
        if not holds.all():
            found = numpy().ones(len(holds), "?")
            inside = _checked(frame, part, checksum, contents.only(holds))
            found[holds] = inside
            return found  # type: ignore[no-any-return]
    return _checked(frame, part, checksum, contents)


def _checked(frame: FastFrame, part: ChecksumPart, checksum: Checksum, contents: Contents) -> Rows:
    values, wrong = _number(contents, frame.offset(part), part.type)
    spec, runs = part.algorithm, _runs(frame, part, contents)
    if spec.kind == "xor":
        due = _folded(numpy().bitwise_xor, contents.octets, runs) ^ spec.init
    elif spec.kind == "sum":
        due = _folded(numpy().add, contents.octets, runs) + numpy().uint8(spec.init)
        due = numpy().negative(due) if spec.negated else due
    else:
        due = _one_by_one(checksum, contents.octets, runs, len(values))
    found: Rows = values == due
    return found if wrong is None else found & ~wrong


_Runs = list["tuple[Rows, Rows] | bytes"]
"""What a checksum covers: bytes, or of each frame the first byte and the place behind the last."""


def _runs(frame: FastFrame, part: ChecksumPart, contents: Contents) -> _Runs:
    def place(bound: int, *, is_end: bool) -> Rows:
        behind = contents.at + contents.size
        return (behind if bound < 0 or (is_end and bound == 0) else contents.at) + bound

    return [
        run if isinstance(run, bytes) else (place(run[0], is_end=False), place(run[1], is_end=True))
        for run in frame.covered_runs(part)
    ]


def _folded(operation: Any, octets: Rows, runs: _Runs) -> Rows:
    """All covered bytes of each frame by an operation on bytes for which 0 changes nothing."""
    total: Any = numpy().uint8(0)
    for run in runs:
        if isinstance(run, bytes):
            more = operation.reduce(numpy().frombuffer(run, "u1"), dtype="u1")
        else:
            more = _folded_spans(operation, octets, *run)
        total = operation(total, more, dtype="u1")
    return total  # type: ignore[no-any-return]


def _folded_spans(operation: Any, octets: Rows, first: Rows, last: Rows) -> Rows:
    bounds = numpy().empty(2 * len(first), "i8")
    bounds[::2], bounds[1::2] = first, last
    if len(bounds) and int(last.max()) == len(octets):
        octets = numpy().append(octets, numpy().uint8(0))
    found: Rows = operation.reduceat(octets, bounds, dtype="u1")[::2]
    # Of no bytes that gives the one behind them.
    found[first == last] = 0
    return found


def _one_by_one(checksum: Checksum, octets: Rows, runs: _Runs, count: int) -> Rows:
    """Frame by frame, as the decoder does it."""
    data = octets.tobytes()
    bounds = [run if isinstance(run, bytes) else [item.tolist() for item in run] for run in runs]
    covered = (
        b"".join(
            run if isinstance(run, bytes) else data[run[0][index] : run[1][index]] for run in bounds
        )
        for index in range(count)
    )
    found: Rows = numpy().array([checksum.compute(item) for item in covered], "u8")
    return found
