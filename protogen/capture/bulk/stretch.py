"""The frames of a stretch of bytes that are in order, and the rows of their messages."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from protogen.capture.arrays import dtype_of, numpy
from protogen.capture.bulk.checking import Framed, framed
from protogen.capture.bulk.contents import contents_of
from protogen.capture.bulk.cutting import Cutting, Span
from protogen.capture.bulk.numbers import either
from protogen.capture.bulk.places import windows
from protogen.capture.bulk.records import read_payloads
from protogen.capture.tables import chosen, concatenated
from protogen.targets.python.fast.frames import FastFrame

if TYPE_CHECKING:
    from protogen.capture.schema import CaptureSchema, TableSchema
    from protogen.capture.tables import Rows
    from protogen.model.messages import Message
    from protogen.model.protocol import Sender
    from protogen.runtime.sender import SenderSpec


@dataclass(frozen=True, slots=True)
class MessageRows:
    """Rows of one message, without sequence numbers, and the frames that they come from."""

    rows: Rows
    frames: Rows


@dataclass(frozen=True, slots=True)
class Stretch:
    """Frames in ascending order, and what their messages hold."""

    frames: Span
    messages: dict[str, MessageRows]


@dataclass(frozen=True, slots=True)
class Run:
    """The frames `first` to `stop` (without it) of a stretch, one behind the other."""

    stretch: Stretch
    first: int
    stop: int


def rows_of_runs(runs: Sequence[tuple[int, Run]]) -> dict[str, list[Rows]]:
    """The rows of each message, in order, of runs with the numbers of their first frames."""
    found: dict[str, list[Rows]] = {}
    for stretch in {id(run.stretch): run.stretch for _, run in runs}.values():
        numbers = numpy().full(len(stretch.frames.at), -1)
        for number, run in runs:
            if run.stretch is stretch:
                numbers[run.first : run.stop] = numpy().arange(
                    number, number + run.stop - run.first
                )
        for name, item in stretch.messages.items():
            sequence = numbers[item.frames]
            taken = sequence >= 0
            rows = item.rows if taken.all() else chosen(item.rows, taken)
            rows["sequence"] = sequence[taken]
            found.setdefault(name, []).append(rows)
    return found


class Bulk:
    """Reads what one endpoint sends."""

    def __init__(
        self, sender: Sender, spec: SenderSpec[Any, Any], schema: CaptureSchema, least: int = 8
    ) -> None:
        """Fewer payloads of one shape than `least` are left to the decoder."""
        self._frame = FastFrame(sender, skips_start=True)
        self._cutting = Cutting(self._frame)
        self._transparency = spec.frame.transparency
        self._checksums = {part.name: part.algorithm for part in spec.layout.checksums}
        self._tables = schema.messages
        self._dtypes = {name: dtype_of(table) for name, table in schema.messages.items()}
        self._least = least

    @staticmethod
    def can_read(sender: Sender) -> bool:
        """Whether anything of what the endpoint sends can be read so."""
        return Cutting.can_cut(FastFrame(sender, skips_start=True))

    def stretch(self, data: bytes, first: int, base: int) -> Stretch:
        """What is in order from the byte `first` on. `base`: the offset of the data."""
        octets = numpy().frombuffer(data, "u1")
        frames = self._cutting.frames(octets, first)
        if not len(frames.at):
            return Stretch(frames, {})
        contents = contents_of(self._frame, self._transparency, octets, frames)
        if not len(contents.at):
            return Stretch(contents.frames, {})
        return self._read(framed(self._frame, self._checksums, octets, contents), base)

    def _read(self, found: Framed, base: int) -> Stretch:
        frames = found.contents.frames
        right = numpy().zeros(len(frames.at), "?")
        pieces: dict[str, list[MessageRows]] = {}
        for message, places in self._by_message(found):
            piece = self._rows(message, places, found)
            right[piece.frames] = True
            pieces.setdefault(message.name, []).append(piece)
        numbers = numpy().cumsum(right) - 1
        messages = {name: _joined(parts, numbers) for name, parts in pieces.items()}
        kept = frames.only(right)
        for name, item in messages.items():
            _fill_head(self._tables[name], item, kept, base)
        return Stretch(kept, messages)

    def _by_message(self, found: Framed) -> Iterator[tuple[Message, Rows]]:
        """Frames that may hold a message, by the size of their payloads."""
        parts = tuple(found.numbers[part.name] for part in self._frame.identity)
        kins = self._cutting.identities.look_up(parts, len(found.payload_size))
        for index, kin in enumerate(self._frame.kins):
            places = numpy().flatnonzero(kins == index)
            for size, alike in _by_number(places, found.payload_size[places]):
                fitting = [message for message in kin.messages if size in message.sizes]
                if fitting and len(alike) >= self._least:
                    yield fitting[0], alike

    def _rows(self, message: Message, places: Rows, found: Framed) -> MessageRows:
        """The rows of frames whose payloads have one size, of those that are in order."""
        table = self._tables[message.name]
        size = int(found.payload_size[places[0]])
        octets = windows(found.contents.octets, found.payload_at[places], size)
        rows = numpy().zeros(len(places), self._dtypes[message.name])
        wrong = read_payloads(message, table.fields, octets, rows, self._least)
        if self._frame.framing.seven_bit and size and int(octets.max()) > 0x7F:
            wrong = either(wrong, octets.max(axis=1) > 0x7F)
        for column in table.columns:
            if column.role == "part":
                rows[column.name] = found.numbers[column.source][places]
        return MessageRows(rows, places) if wrong is None else _without(rows, places, wrong)


def _without(rows: Rows, places: Rows, wrong: Rows) -> MessageRows:
    return MessageRows(chosen(rows, ~wrong), places[~wrong])


def _by_number(places: Rows, numbers: Rows) -> Iterator[tuple[int, Rows]]:
    """The places of each number."""
    if not len(places):
        return
    least, greatest = int(numbers.min()), int(numbers.max())
    if least == greatest:
        yield least, places
        return
    for number in numpy().unique(numbers).tolist():
        yield number, places[numbers == number]


def _joined(parts: list[MessageRows], numbers: Rows) -> MessageRows:
    """All rows in the order of the frames, which get other numbers."""
    if len(parts) == 1:
        return MessageRows(parts[0].rows, numbers[parts[0].frames])
    frames = numpy().concatenate([item.frames for item in parts])
    order = numpy().argsort(frames)
    rows = chosen(concatenated([item.rows for item in parts]), order)
    return MessageRows(rows, numbers[frames[order]])


def _fill_head(table: TableSchema, found: MessageRows, frames: Span, base: int) -> None:
    """Where the frames stand in the capture."""
    at = frames.at[found.frames]
    for column in table.columns:
        if column.role == "offset":
            found.rows[column.name] = at + base
        elif column.role == "size":
            found.rows[column.name] = frames.end[found.frames] - at
