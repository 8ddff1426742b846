"""What is counted of a line: rates, gaps, what was no frame, how busy it is."""

from __future__ import annotations

from collections import deque
from collections.abc import Mapping
from fractions import Fraction
from itertools import pairwise
from typing import Any

import msgspec

from protogen.model.frame import Frame
from protogen.model.parts import CounterPart
from protogen.model.protocol import Protocol
from protogen.runtime.attributes import attribute

_SECOND = 10**9
_WINDOW = 512
"""So many arrivals of a message tell its rate."""
_RECENT = 10 * _SECOND
"""Older arrivals tell nothing of the rate now, unless they are the last ones."""


class MessageStatistics:
    """One kind of message of one endpoint."""

    def __init__(self, sender: str, name: str) -> None:
        self.sender = sender
        self.name = name
        self.count = 0
        self.gaps = 0
        """Frames that are missing in front of these, as the sender's counter tells."""
        self.last: Any = None
        """The last event."""
        self._before: Any = None
        self._times: deque[int] = deque(maxlen=_WINDOW)

    @property
    def when(self) -> int:
        """Time of the last one, in nanoseconds since 1970."""
        return self._times[-1]

    @property
    def values(self) -> Mapping[str, Any]:
        """The last fields, as lines of JSON have them."""
        return _values_of(self.last)

    @property
    def changed(self) -> frozenset[str]:
        """The fields whose values differ from those of the event before."""
        before = _values_of(self._before)
        return frozenset(
            name for name, value in self.values.items() if before and before.get(name) != value
        )

    def take(self, event: Any, when: int, missing: int) -> None:
        """Count one that came at `when`, with so many missing in front."""
        self.count += 1
        self.gaps += missing
        self._times.append(when)
        while self._times[-1] - self._times[0] > _RECENT and len(self._times) > 2:
            self._times.popleft()
        self._before, self.last = self.last, event

    def rate(self, now: int) -> float:
        """How many come in a second. A message that has stopped fades."""
        if len(self._times) < 2:
            return 0.0
        passed = self._times[-1] - self._times[0]
        mean = passed / (len(self._times) - 1)
        silent = now - self._times[-1]
        # Two intervals without one are no accident any more.
        spent = passed if silent < 2 * mean else passed + silent
        return (len(self._times) - 1) * _SECOND / spent if spent else 0.0

    @property
    def jitter(self) -> float:
        """Standard deviation of the time from one to the next, in seconds."""
        if len(self._times) < 3:
            return 0.0
        times = list(self._times)
        steps = [later - earlier for earlier, later in pairwise(times)]
        mean = sum(steps) / len(steps)
        return float((sum((step - mean) ** 2 for step in steps) / len(steps)) ** 0.5 / _SECOND)


class SourceStatistics(msgspec.Struct):
    """Bytes of one end of the line."""

    bytes: int = 0
    recent: deque[tuple[int, int]] = msgspec.field(default_factory=deque)
    """Times and sizes of what came in the last second."""

    def take(self, size: int, when: int) -> None:
        """Count bytes that came at `when`."""
        self.bytes += size
        self.recent.append((when, size))
        self.forget(when)

    def forget(self, now: int) -> None:
        """Forget what is older than a second."""
        while self.recent and now - self.recent[0][0] > _SECOND:
            self.recent.popleft()

    def per_second(self, now: int) -> int:
        """Bytes of the last second."""
        self.forget(now)
        return sum(size for _, size in self.recent)


class LineStatistics:
    """Counts what is on a line."""

    def __init__(self, protocol: Protocol) -> None:
        self._byte_time = protocol.link.byte_time
        self._counters = {
            sender.endpoint: counter
            for sender in protocol.senders
            if (counter := _counter(sender.frame)) is not None
        }
        self._expected: dict[str, int] = {}
        self.messages: dict[tuple[str, str], MessageStatistics] = {}
        """Each kind by its endpoint and name."""
        self.sources: dict[str, SourceStatistics] = {}
        self.unknown = 0
        """Frames of no message."""
        self.invalid: dict[str, int] = {}
        """Spans that are no frame, by reason."""
        self.invalid_bytes = 0

    def take_bytes(self, source: str, size: int, when: int) -> None:
        """Count bytes of a source."""
        self.sources.setdefault(source, SourceStatistics()).take(size, when)

    def take(self, event: Any, when: int) -> None:
        """Count an event that was complete at `when`, in nanoseconds since 1970."""
        if event.kind == "invalid":
            self.invalid[event.reason] = self.invalid.get(event.reason, 0) + 1
            self.invalid_bytes += len(event.raw)
            return
        missing = self._missing(event)
        if event.kind == "unknown":
            self.unknown += 1
            return
        key = event.sender, event.message.NAME
        if key not in self.messages:
            self.messages[key] = MessageStatistics(*key)
        self.messages[key].take(event, when, missing)

    def load(self, source: str, now: int) -> float | None:
        """Share of the line's time that a source used in the last second; None without a rate."""
        if self._byte_time is None or source not in self.sources:
            return None
        return float(Fraction(self.sources[source].per_second(now)) * self._byte_time)

    def _missing(self, event: Any) -> int:
        """Frames that the sender's counter says are missing in front of this one."""
        counter = self._counters.get(event.sender)
        name = "" if counter is None else attribute(counter.name)
        if counter is None or not hasattr(event.parts, name):
            return 0
        value = int(getattr(event.parts, name))
        size = counter.greatest - counter.least + 1
        expected = self._expected.get(event.sender, value)
        self._expected[event.sender] = counter.least + (value - counter.least + 1) % size
        missing = (value - expected) % size
        # The same counter once more is a repetition: that all others are missing is unlikely.
        return 0 if missing == size - 1 else missing


def _values_of(event: Any) -> Mapping[str, Any]:
    """Fields of an event, if there is one. A line has many that nobody looks at."""
    values: Mapping[str, Any] = {} if event is None else event.message.to_dict()
    return values


def _counter(frame: Frame) -> CounterPart | None:
    return next((part for part in frame.parts if isinstance(part, CounterPart)), None)
