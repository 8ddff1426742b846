"""What a receiver is told of parts that are not sent: by its program, or by frames."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any

from protogen.runtime.attributes import attribute, schema_name
from protogen.runtime.errors import EncodeError
from protogen.runtime.framing.frame import LengthPart, ToldPart
from protogen.runtime.framing.layout import Layout
from protogen.runtime.framing.sender import SenderSpec
from protogen.runtime.payload.message import Message
from protogen.runtime.payload.number import given_number

GivenNumber = int | Sequence[int]
"""A number, or those of frames that follow each other."""


class Told:
    """The values of a decoder's told parts, by their names.

    A part that several forms of frame have has one value for all of them.
    """

    def __init__(self, senders: Sequence[SenderSpec[Any, Any]]) -> None:
        self._layouts: dict[str, list[Layout]] = {}
        """The frames that have a part of the name."""
        self._parts: dict[str, ToldPart] = {}
        for sender in senders:
            for part in sender.frame.told:
                self._parts[part.name] = part
                self._layouts.setdefault(part.name, []).append(sender.layout)
        self._values: dict[str, int] = {name: part.default for name, part in self._parts.items()}
        self._next: dict[str, list[int]] = {name: [] for name in self._parts}
        self._new: dict[str, list[int]] = {}
        """What was told since a frame began."""

    @property
    def current(self) -> Mapping[str, int]:
        """What holds for the frame that is coming in, or was the last."""
        return self._values

    def begin_frame(self) -> Mapping[str, int]:
        """What holds for a frame that begins now."""
        for name, (first, *others) in self._new.items():
            self._values[name] = first
            self._next[name] = others
        self._new = {}
        return {**self._values}

    def of_one_frame(self, given: Mapping[str, GivenNumber]) -> Mapping[str, int]:
        """The same of one frame that is all there is, without lengths that are not `given`."""
        known = self.begin_frame()
        names = {schema_name(name) for name in given}
        lengths = {name for name, part in self._parts.items() if part.length}
        return {name: known[name] for name in known if name in names or name not in lengths}

    def __bool__(self) -> bool:
        return bool(self._parts)

    def tell(self, given: Mapping[str, GivenNumber]) -> None:
        """Take values, or those of the frames to come, one after another; all of them or none.

        Raises ValueError where no part has the name, the part can't hold it, or no frame has the
        length.
        """
        self._new |= {
            part.name: values for part, values in map(self._checked, given, given.values())
        }

    def _checked(self, name: str, given: GivenNumber) -> tuple[ToldPart, list[int]]:
        part = self._parts.get(schema_name(name))
        if part is None:
            known = ", ".join(self._parts) or "there is none"
            raise ValueError(f"no part that is told is called {name!r}: {known}")
        listed = given if isinstance(given, Sequence) else [given]
        try:
            values = [given_number(part.number, value) for value in listed]
        except EncodeError as error:
            raise ValueError(f"{name} {error.problem}") from None
        wrong = [value for value in values if not 0 <= value < 1 << part.number.bits]
        if wrong:
            raise ValueError(f"{name} can't be {wrong[0]}: it has {part.number.bits} bits")
        if part.length is not None:
            self._check_lengths(part, part.length, values)
        return part, values or [part.default]

    def _check_lengths(self, part: ToldPart, length: LengthPart, values: Iterable[int]) -> None:
        """Raise ValueError for a length that no frame has, but for the one before any is told."""
        layouts = self._layouts[part.name]
        for value in values:
            sizes = (layout.counted_payload(length, value) for layout in layouts)
            if value != part.default and all(size is None for size in sizes):
                least = min(layout.bounds(length)[0] for layout in layouts)
                greatest = max(layout.bounds(length)[1] for layout in layouts)
                raise ValueError(f"{part.name} can't be {value}: it is from {least} to {greatest}")

    def pass_frame(
        self, sender: SenderSpec[Any, Any], numbers: Mapping[str, int], message: Message | None
    ) -> None:
        """Take a frame: what was told of it may hold no more, and it may tell something itself."""
        for part in sender.frame.told:
            following = self._next[part.name]
            if following or part.once:
                self._values[part.name] = following.pop(0) if following else part.default
        self.hear(sender, numbers, message)

    def hear(
        self, sender: SenderSpec[Any, Any], numbers: Mapping[str, int], message: Message | None
    ) -> None:
        """Take the numbers of a frame, which may tell something of those behind it."""
        told = {part.name for part in sender.frame.told}
        sent = {name: value for name, value in numbers.items() if name not in told}
        for part in self._parts.values():
            for values in _told_by(part, sent, message):
                self._new[part.name] = values or [part.default]


def _told_by(
    part: ToldPart, numbers: Mapping[str, int], message: Message | None
) -> Iterator[list[int]]:
    """The values that a frame tells of a part."""
    for name, field in part.set_by:
        if not field and name in numbers:
            yield [numbers[name]]
        elif field and message is not None and name == message.NAME:
            value = getattr(message, attribute(field))
            if value is not None:
                yield [int(item) for item in value] if isinstance(value, Sequence) else [int(value)]
