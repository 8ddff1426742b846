"""Frames that one version sends and the other reads differently."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Sequence
from enum import StrEnum
from itertools import islice
from random import Random
from typing import Any

import msgspec

from protogen.copying import replace
from protogen.evolution.change import Change, Mark
from protogen.evolution.compare import Comparison
from protogen.evolution.observe import Reading, Side
from protogen.fuzzing.samples import Values, boundary_rounds, samples
from protogen.model.messages import Message
from protogen.model.protocol import Sender

ROUNDS = 64
"""Samples with boundaries, at most."""
RANDOM = 60
"""Random samples behind these."""
_LONGEST = 48
"""Characters of a value that are shown."""
MARKED = 40
"""Samples in which a value is looked at that has a name in one version."""
_DULL = re.compile(r"[-0. ]*(\(.*\))?", re.DOTALL)
_INDEX = re.compile(r"\[\d+\]")


_OF_FRAMES = frozenset({"noise", "truncated", "length", "checksum", "stuffing", "encoding"})
"""Reasons to lose a frame whatever message it has."""


class Harm(StrEnum):
    """Fate of a frame at the other end."""

    REJECTED = "rejected"
    """The frame is lost."""
    MISREAD = "misread"
    """A wrong value, or another message, and no error."""
    LOST = "lost"
    """New information is ignored."""


class Difference(msgspec.Struct, frozen=True):
    """A value that is read as another one."""

    path: str
    sent: str | None
    """None where only the receiver sees it."""
    received: str | None
    """None where the receiver does not see it."""


class Witness(msgspec.Struct, frozen=True):
    """A frame, and both readings of it."""

    old_sends: bool
    """True if OLD sends and NEW reads; False the other way round."""
    sender: str
    message: str
    frame: bytes
    sent: Reading
    received: Reading
    harm: Harm
    differences: tuple[Difference, ...]

    @property
    def words(self) -> str:
        """The witness in one line."""
        one, other = ("old", "new") if self.old_sends else ("new", "old")
        bytes_ = self.frame[:24].hex(" ").upper() + (" ..." if len(self.frame) > 24 else "")
        return f"{one} {self.sender} sends {self.message} {bytes_}; {other} {self._reads()}"

    def _reads(self) -> str:
        if self.harm is Harm.REJECTED:
            return f"finds no message in it: {self.received.why}"
        if not self.differences:
            return f"reads {self.received.message}"
        item = self.differences[0]
        if item.received is None:
            return f"ignores {item.path}, which was {_shown(item.sent)}"
        if item.sent is None:
            return f"reads {item.path} {_shown(item.received)}, which nobody sent"
        return f"reads {item.path} {_shown(item.received)} where {_shown(item.sent)} was meant"


class Witnesses:
    """Looks for frames that show what a change does."""

    def __init__(self, comparison: Comparison) -> None:
        self._comparison = comparison
        self._old, self._new = Side(comparison.old), Side(comparison.new)
        self._found: dict[tuple[bool, str, str], list[Witness]] = {}

    def of(self, change: Change) -> list[Witness]:
        """The best witness of each direction that has one, OLD's frames first."""
        found = []
        for old_sends in (True, False):
            best = self._best(change, old_sends)
            if best is not None:
                found.append(best)
        return found

    def tries_all_bounds(self, change: Change) -> bool:
        """True if each value that the change may touch is tried at each of its bounds."""
        return all(
            boundary_rounds(message, sender.frame) <= ROUNDS
            for old_sends in (True, False)
            for sender, message in self._sendings(change, old_sends)
        )

    def _best(self, change: Change, old_sends: bool) -> Witness | None:
        seen = [
            witness
            for sender, message in self._sendings(change, old_sends)
            for witness in self._seen(change, old_sends, sender, message)
        ]
        if change.rule == "frame-length-range":
            seen = [witness for witness in seen if witness.received.why == "length"]
        if change.message is None:
            untouched = [witness for witness in seen if not self._has_changed(witness)]
            return min(untouched, key=_rank, default=min(seen, key=_rank_of_frames, default=None))
        fitting = (_fitted(witness, change) for witness in seen)
        return min((item for item in fitting if item is not None), key=_rank, default=None)

    def _seen(
        self, change: Change, old_sends: bool, sender: Sender, message: Message
    ) -> list[Witness]:
        """Frames of a message that differ; if the change is of one value, those that hold it."""
        mark = change.marks[0 if old_sends else 1]
        if change.is_lost and not old_sends:
            return []  # Nobody sends what has no name any more.
        if mark is None or change.path is None:
            return self.differing(old_sends, sender, message)
        path = change.path if old_sends else change.now or change.path
        if change.selector is not None:
            seen = self.differing(old_sends, sender, message)
            paths = _around(path, change.selector)
            return [item for item in seen if any(_holds(item.sent, at, mark) for at in paths)]
        drawn = islice(self._samples(old_sends, sender, message), MARKED)
        samples = [(_marked(values, path.split("."), mark), parts) for values, parts in drawn]
        return [
            witness
            for witness in self._look(old_sends, sender, message, samples)
            if _holds(witness.sent, path, mark)
        ]

    def _has_changed(self, witness: Witness) -> bool:
        """True if the message has changes of its own, which the witness may show."""
        names = self._comparison
        name = witness.message
        if not witness.old_sends:
            name = _key_of(names.messages, name)
        return any(name in _messages_of(change) for change in names.changes)

    # --- what is sent -----------------------------------------------------------------------------

    def _sendings(self, change: Change, old_sends: bool) -> Iterator[tuple[Sender, Message]]:
        """Senders and messages of one side that a change may touch."""
        names = self._comparison
        for sender in (names.old if old_sends else names.new).senders:
            before = sender.name if old_sends else _key_of(names.endpoints, sender.name)
            if change.sender not in (None, before):
                continue
            for message in sender.messages:
                name = message.name if old_sends else _key_of(names.messages, message.name)
                taken = not old_sends and message.name in change.taken_by
                if taken or change.message in (None, name):
                    yield sender, message

    def differing(self, old_sends: bool, sender: Sender, message: Message) -> list[Witness]:
        """Frames of a message that the other side reads differently."""
        key = old_sends, sender.name, message.name
        if key not in self._found:
            samples = self._samples(old_sends, sender, message)
            self._found[key] = list(self._look(old_sends, sender, message, samples))
        return self._found[key]

    def _look(
        self,
        old_sends: bool,
        sender: Sender,
        message: Message,
        samples: Iterable[tuple[Values, Values]],
    ) -> Iterator[Witness]:
        names = self._comparison
        one, other = (self._old, self._new) if old_sends else (self._new, self._old)
        endpoints = names.endpoints if old_sends else _swapped(names.endpoints)
        theirs = endpoints.get(sender.endpoint, sender.endpoint)
        listens = theirs in other.protocol.sending
        for values, parts in samples:
            frame = one.frame(sender.name, message.name, values, parts)
            if frame is None:
                continue
            told = sender.plan.told_before(message, parts, len(frame))
            sent = one.reads(sender.endpoint, frame, told=told)
            if sent.message != message.name:
                continue  # A frame that its own side can't tell proves nothing.
            received = Reading(None, "nobody listens")
            if listens:
                received = other.reads(theirs, frame, like=sent, told=told)
            harm, differences = self._judged(sent, received, old_sends)
            if harm is not None:
                yield Witness(
                    old_sends,
                    sender.name,
                    message.name,
                    frame,
                    sent,
                    received,
                    harm,
                    tuple(differences),
                )

    def _samples(
        self, old_sends: bool, sender: Sender, message: Message
    ) -> Iterator[tuple[Values, Values]]:
        """Values at the bounds of both versions, and random ones."""
        yield from _drawn(message, sender)
        messages = self._comparison.messages
        name = (messages if old_sends else _swapped(messages)).get(message.name)
        other = self._new if old_sends else self._old
        for theirs in other.protocol.messages:
            if theirs.name != name or _is_drawn_alike(theirs, message):
                continue
            if _names(theirs) == _names(message):
                yield from _drawn(theirs, sender)

    # --- what is read -----------------------------------------------------------------------------

    def _judged(
        self, sent: Reading, received: Reading, old_sends: bool
    ) -> tuple[Harm | None, list[Difference]]:
        if received.message is None:
            return Harm.REJECTED, []
        messages = self._comparison.messages
        expected = (messages if old_sends else _swapped(messages)).get(sent.message or "")
        if received.message != expected:
            return Harm.MISREAD, []
        differences = list(self._differences(sent, received, old_sends))
        if any(item.received is not None for item in differences):
            return Harm.MISREAD, sorted(differences, key=lambda item: item.received is None)
        return (Harm.LOST, differences) if differences else (None, [])

    def _differences(
        self, sent: Reading, received: Reading, old_sends: bool
    ) -> Iterator[Difference]:
        name = sent.message if old_sends else received.message
        renamed = {
            change.path: change.now
            for change in self._comparison.changes
            if change.now is not None and change.path is not None and change.message == name
        }
        parts = {
            f"frame.{change.old_part}": f"frame.{change.new_part}"
            for change in self._comparison.changes
            if change.old_part is not None
        }
        names = {**renamed, **parts}
        if not names and sent.contents is received.contents and sent.parts == received.parts:
            return
        theirs = dict(received.meanings)
        mapping = names if old_sends else _swapped(names)
        for path, meaning in sent.meanings.items():
            place = _translated(path, mapping)
            if place not in theirs:
                yield Difference(path, sent.values[path], None)
            elif theirs.pop(place) != meaning:
                yield Difference(path, sent.values[path], received.values[place])
        filled = received.contents.filled
        for path in (path for path in theirs if path not in filled):
            yield Difference(path, None, received.values[path])


def _drawn(message: Message, sender: Sender) -> Iterator[tuple[Values, Values]]:
    dice = Random(message.name)  # noqa: S311 - nothing secret
    count = min(boundary_rounds(message, sender.frame), ROUNDS) + RANDOM
    yield from islice(samples(message, sender.frame, dice), count)


def _is_drawn_alike(one: Message, other: Message) -> bool:
    """True if the same samples are drawn for both."""
    shapes = [(m.name, m.fields, m.unspecified, m.sizes) for m in (one, other)]
    return shapes[0] == shapes[1]


def _shown(value: str | None) -> str:
    if not value:
        return "nothing"
    if len(value) <= _LONGEST:
        return value
    return f"{value[: _LONGEST - 4]} ... ({len(value)} characters)"


def _names(message: Message) -> list[str]:
    return [field.name for field in message.fields]


def _translated(path: str, names: dict[str, str]) -> str:
    """The path with the names that the other side has."""
    bare = _INDEX.sub("", path)
    for before, after in names.items():
        if bare == before or bare.startswith(f"{before}."):
            head, last = before.rpartition(".")[0], before.rpartition(".")[2]
            depth = head.count(".") + 1 if head else 0
            words = path.split(".")
            words[depth] = words[depth].replace(last, after.rpartition(".")[2], 1)
            path = ".".join(words)
            bare = _INDEX.sub("", path)
    return path


def _is_inside(path: str, places: set[str]) -> bool:
    bare = _INDEX.sub("", path)
    return any(bare == place or bare.startswith(f"{place}.") for place in places)


def _fitted(witness: Witness, change: Change) -> Witness | None:
    """The witness with no more than what the change does; None where that is nothing."""
    if change.path is None or not witness.differences:
        return witness
    paths = {change.path, change.now or change.path}
    inside = tuple(item for item in witness.differences if _is_inside(item.path, paths))
    if not inside:
        return None
    is_misread = any(item.received is not None for item in inside) and not change.is_lost
    if change.rule == "field-added" and not is_misread:
        return None  # A receiver that leaves what it never knew loses nothing.
    return replace(witness, differences=inside, harm=Harm.MISREAD if is_misread else Harm.LOST)


def _messages_of(change: Change) -> set[str | None]:
    """The messages that a change is in, by their names in OLD."""
    return {change.message, *(place.partition(".")[0] for place in change.places)}


# --- values that have to be looked at -------------------------------------------------------------


def _marked(value: Any, steps: Sequence[str], mark: Mark) -> Any:
    """The values with those at a path as the mark has them; the same where nothing is there."""
    if isinstance(value, list):
        return [_marked(item, steps, mark) for item in value]
    if not steps:
        return mark.put(value) if isinstance(value, int) else value
    if not isinstance(value, dict) or steps[0] not in value:
        return value
    return {**value, steps[0]: _marked(value[steps[0]], steps[1:], mark)}


def _around(path: str, name: str) -> list[str]:
    """Places of a field that something at a path depends on: beside it, or further out."""
    steps = path.split(".")[:-1]
    return [".".join([*steps[:count], name]) for count in range(len(steps) + 1)]


def _holds(reading: Reading, path: str, mark: Mark) -> bool:
    """True if a value at the path is as the mark has it."""
    found = (raw for place, raw in reading.raw.items() if _INDEX.sub("", place) == path)
    return any(mark.on(raw) for raw in found)


def _rank(witness: Witness) -> tuple[int, bool, int]:
    """The most telling first: a wrong value before a lost frame, no zeros, and short frames."""
    order = [Harm.MISREAD, Harm.REJECTED, Harm.LOST]
    shown = witness.differences[0] if witness.differences else None
    value = (shown.sent or shown.received or "") if shown is not None else "-"
    return order.index(witness.harm), _DULL.fullmatch(value) is not None, len(witness.frame)


def _rank_of_frames(witness: Witness) -> tuple[bool, int]:
    """A frame that is lost before anybody looks inside shows most of what frames are about."""
    return witness.received.why not in _OF_FRAMES, len(witness.frame)


def _swapped(names: dict[str, str]) -> dict[str, str]:
    return {after: before for before, after in names.items()}


def _key_of(names: dict[str, str], name: str) -> str:
    return _swapped(names).get(name, name)
