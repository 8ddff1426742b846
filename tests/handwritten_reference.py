"""The decoder's rules once more: a slow reader of whole inputs, to compare the decoder with.

It shares declarations, message formats, checksums and unstuffing with the runtime, and nothing of
its machine. For a possible start it works out everything that could happen to the candidate, each
with the byte at which it happens, and takes the earliest; what happens at the same byte is ordered
as the rules say.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

from protogen.runtime import api as rt
from protogen.runtime.constructs import PayloadError, Whole, prefix_size
from protogen.runtime.transparency import TransparencyError

NEVER = 10**9
START, END, STUFFING, LENGTH, CONTENT, SIZE, COMPLETE, GREATEST = range(8)
"""What happens at the same byte happens in this order."""


Time = tuple[int, int]
"""The wire byte at which something happens, and the one that was held back until then.

-1 comes before all that were held, NEVER behind them.
"""


@dataclass(frozen=True)
class Fails:
    size: int
    reason: str


@dataclass(frozen=True)
class Frames:
    size: int
    parts: dict[str, int]
    payload: bytes


Outcome = Fails | Frames


def reference_events(sender: Any, data: bytes) -> list[tuple[Any, ...]]:
    """(offset, raw, kind, reason, parts, message or payload) of each event of the whole input."""
    return list(_Input(sender, data).events())


def summary(event: Any) -> tuple[Any, ...]:
    """The same of an event of the decoder."""
    reason = event.reason if event.kind == "invalid" else None
    parts = None if event.kind == "invalid" else event.as_json()["parts"]
    found = {"message": "message", "unknown": "payload"}.get(event.kind)
    value = getattr(event, found) if found else None
    return (event.offset, event.raw, event.kind, reason, parts, value)


class _Input:
    def __init__(self, sender: Any, data: bytes) -> None:
        self.sender = sender
        self.spec: rt.FrameSpec = sender.frame
        self.data = data

    def is_start(self, place: int) -> bool:
        start = self.spec.start
        if isinstance(start, rt.StartWords):
            return any(self.data[place:].startswith(word) for word in start.words)
        if isinstance(start, rt.StartLiteral):
            return self.data[place:].startswith(start.value)
        if isinstance(start, rt.StartSet):
            return place < len(self.data) and start.least <= self.data[place] <= start.greatest
        if isinstance(start, rt.AfterEnd):
            assert self.spec.end is not None
            return place == 0 or self.data[:place].endswith(self.spec.end.value)
        return True

    def next_start(self, low: int, high: int) -> int | None:
        return next((place for place in range(low, high) if self.is_start(place)), None)

    def events(self) -> Iterator[tuple[Any, ...]]:
        done = place = 0
        shared = b""  # The end of the frame before, where it may be a start as well.
        while place < len(self.data):
            start = place if shared else self.next_start(place, len(self.data))
            if start is None:
                break
            anywhere = isinstance(self.spec.start, rt.Anywhere)
            if not anywhere:
                yield from self.noise(done, start)
                done = start
            outcome = self.judge(start, shared)
            end = start + outcome.size - len(shared)
            if anywhere and end - done > self.spec.greatest:
                yield from self.noise(done, start)
                done = start
            if isinstance(outcome, Frames):
                yield from self.noise(done, start)
                yield self.frame(start, end, outcome)
                done = place = end
                shared = self.shared_delimiter()
                continue
            had_shared, shared = shared, b""
            if had_shared and self.is_start(start):
                continue
            if anywhere:
                place = start + 1
            else:
                after = self.next_start(start + 1, end) or end
                yield (start, self.data[start:after], "invalid", outcome.reason, None, None)
                done = place = after
        yield from self.noise(done, len(self.data))

    def noise(self, start: int, end: int) -> Iterator[tuple[Any, ...]]:
        for place in range(start, end, self.spec.greatest):
            raw = self.data[place : min(place + self.spec.greatest, end)]
            yield (place, raw, "invalid", "noise", None, None)

    def shared_delimiter(self) -> bytes:
        """The literal that ends a frame and may start the next, if it is one and the same."""
        start, end = self.spec.start, self.spec.end
        if isinstance(start, rt.StartLiteral) and end is not None and start.value == end.value:
            return start.value
        return b""

    def frame(self, start: int, end: int, outcome: Frames) -> tuple[Any, ...]:
        raw = self.data[start:end]
        messages = candidates(self.sender, outcome.parts)
        shown = {
            part.name: outcome.parts[part.name]
            for part in self.spec.parts
            if isinstance(part, rt.IdentityPart | rt.ValuePart)
        }
        if not messages:
            return (start, raw, "unknown", None, shown, outcome.payload)
        message = read_payload(messages, outcome.payload)
        return (start, raw, "message", None, shown, message)

    def judge(self, start: int, shared: bytes) -> Outcome:
        outcome = _Candidate(self.sender, shared + self.data[start:]).outcome()
        if isinstance(outcome, Frames):
            messages = candidates(self.sender, outcome.parts)
            try:
                if messages:
                    read_payload(messages, outcome.payload)
            except PayloadError as error:
                return Fails(outcome.size, error.reason)
        return outcome


def candidates(sender: Any, parts: dict[str, int]) -> list[Any]:
    names = [part.name for part in sender.frame.parts if isinstance(part, rt.IdentityPart)]
    identity = tuple(parts[name] for name in names)
    return [message for message in sender.messages if identity == message.IDENTITY]


def read_payload(messages: list[Any], payload: bytes) -> Any:
    fitting = [message for message in messages if len(payload) in message.SIZES]
    if not fitting:
        raise PayloadError("size", "", 0, "no message has this size")
    Whole(fitting[0].FORMAT).parse(payload)
    return fitting[0].from_payload(payload)


@dataclass
class _Content:
    """Content, each byte with the time at which it is known."""

    values: bytes = b""
    times: list[Time] = field(default_factory=list)
    wire_ends: list[int] = field(default_factory=list)
    broken: tuple[Time, str] | None = None
    """When and why the unstuffing failed."""
    region_end: int | None = None
    """The wire byte behind the region, if it was ended by its size."""
    surplus: Time = (NEVER, -1)
    """When a byte came that is behind all content."""

    def put(self, value: int, time: Time, wire_end: int) -> None:
        self.values += bytes((value,))
        self.times.append(time)
        self.wire_ends.append(wire_end)


class _Candidate:
    def __init__(self, sender: Any, wire: bytes) -> None:
        self.sender = sender
        self.spec: rt.FrameSpec = sender.frame
        self.wire = wire
        start = self.spec.start
        self.start = start.value if isinstance(start, rt.StartLiteral) else b""
        self.marks = {self.start} - {b""}
        if isinstance(start, rt.StartWords):
            self.marks = {word for word in start.words if len(word) > 1}
        self.mark_size = max(map(len, self.marks), default=0)
        self.end = self.spec.end.value if self.spec.end else b""
        parts = list(self.spec.parts)
        size = len(self.end)
        while size > 0:
            size -= parts.pop().size
        index = next(i for i, part in enumerate(parts) if isinstance(part, rt.PayloadPart))
        self.parts, self.head, self.tail = parts, parts[:index], parts[index + 1 :]
        self.head_size = sum(part.size for part in self.head)
        self.numbers: dict[str, int] = {}
        self.happenings: list[tuple[Time, int, Outcome]] = []
        self.payload: int | None = None
        self.messages: list[Any] = []

    # The outcome is what happens first.
    def outcome(self) -> Outcome:
        self.look()
        if len(self.wire) >= self.spec.greatest:
            self.fails((self.spec.greatest - 1, NEVER), GREATEST, "length")
        self.happenings.sort(key=lambda item: item[:2])
        return self.happenings[0][2]

    def fails(self, when: Time | int, order: int, reason: str, size: int | None = None) -> None:
        time = when if isinstance(when, tuple) else (when, -1)
        outcome = Fails(min(time[0] + 1, len(self.wire)) if size is None else size, reason)
        self.happenings.append((time, order, outcome))

    def tail_size(self, payload: int) -> int:
        present = (part for part in self.tail if payload or not getattr(part, "when_payload", 0))
        return sum(int(part.size) for part in present)

    def total(self) -> int:
        assert self.payload is not None
        return self.head_size + self.payload + self.tail_size(self.payload)

    def length_part(self) -> rt.LengthPart | None:
        return next((part for part in self.head if isinstance(part, rt.LengthPart)), None)

    def announced(self) -> str:
        return "length" if self.length_part() else "size"

    def look(self) -> None:
        self.look_for_nothing()
        protected_end = self.spec.end is not None and self.spec.end.protected
        found, times, limit = self.search(self.mark_size, {self.end} if protected_end else set())
        content = self.unstuff(times, limit, None)
        opened = self.read_head(content)
        if self.payload is None and (opened is None or protected_end or self.measures()):
            self.look_broken(content)
        self.ends_at_start = self.payload is None and not self.end and not self.messages
        if self.payload is not None:
            self.look_known(found, times, limit, protected_end)
        elif opened is not None and self.measures():
            self.measure(content, times, limit)
        elif opened is not None:
            self.look_open(content, opened, found, times, limit, protected_end)
        else:
            self.close_early(content, found)
        self.look_for_start(opened)

    def measures(self) -> bool:
        return not self.end and bool(self.messages)

    def look_broken(self, content: _Content) -> None:
        if content.broken:
            self.fails(content.broken[0], STUFFING, content.broken[1])

    # --- delimiters ------------------------------------------------------------------------------

    def look_for_nothing(self) -> None:
        """Nothing in front of the end."""
        if isinstance(self.spec.start, rt.AfterEnd):
            if self.wire.startswith(self.end):
                self.fails(len(self.end) - 1, END, "noise")
        elif self.start == self.end != b"" and self.wire.startswith(self.start + self.end):
            self.fails(2 * len(self.end) - 1, END, "noise", size=len(self.start))

    def look_for_start(self, opened: int | None) -> None:
        """A protected start inside."""
        start = self.spec.start
        if (getattr(start, "protected", False) and self.start != self.end) or (
            isinstance(start, rt.StartSet | rt.StartWords) and start.protected
        ):
            place = self.start_behind(1)
            ends = opened is not None and self.ends_at_start and place >= opened
            if place < NEVER and not ends:
                time = place + max(self.mark_size, 1) - 1
                self.fails(time, START, "truncated", size=place)

    def start_behind(self, low: int) -> int:
        source = _Input(self.sender, self.wire)
        found = source.next_start(low, len(self.wire))
        return NEVER if found is None else found

    def search(self, low: int, delimiters: set[bytes]) -> tuple[int | None, list[Time], int]:
        """Where a delimiter is, when each byte in front of it is known not to begin one.

        The last is how many bytes are known so; the others are held at the end of the input.
        """
        size = len(self.wire)
        if not delimiters:
            return None, [(place, place) for place in range(size)], size
        places = [place for word in delimiters if (place := self.wire.find(word, low)) >= 0]
        found = min(places, default=-1)
        limit = size if found < 0 else found
        times = [(place, place) for place in range(min(low, limit))]
        last = size if found < 0 else found + len(next(iter(delimiters))) - 1
        for place in range(low, limit):
            free = (t for t in range(place, last) if not self.held(place, t, delimiters, low))
            times += [(next(free, NEVER), place)]
        if found < 0:
            limit = next((i for i, time in enumerate(times) if time[0] == NEVER), limit)
        return (None if found < 0 else found), times, limit

    def held(self, place: int, time: int, delimiters: set[bytes], low: int) -> bool:
        """Whether, with all up to `time` taken, the byte may still belong to a delimiter."""
        return any(
            delimiter.startswith(self.wire[first : time + 1])
            for delimiter in delimiters
            for first in range(max(low, time + 2 - len(delimiter)), place + 1)
        )

    # --- unstuffing ------------------------------------------------------------------------------

    def unstuff(
        self, times: list[Time], limit: int, total: int | None, by_size: bool = False
    ) -> _Content:
        """The content of the first `limit` wire bytes; `by_size`: its total ends the region."""
        content = _Content()
        place = 0
        stuffed = [i for i, part in enumerate(self.parts) if part.name in self.spec.stuffed]
        if stuffed:
            raw = sum(part.size for part in self.parts[: stuffed[0]])
            while place < min(raw, limit):
                content.put(self.wire[place], times[place], place + 1)
                place += 1
            if place < raw:
                return content
            place = self.region(content, place, times, limit, total, by_size, stuffed[-1])
            if content.broken or place >= limit:
                return content
        while place < limit:
            if total is not None and len(content.values) >= total:
                if not (by_size and self.end):  # An end that is not protected has to stand here.
                    content.surplus = min(content.surplus, times[place])
                return content
            content.put(self.wire[place], times[place], place + 1)
            place += 1
        return content

    def region(
        self,
        content: _Content,
        place: int,
        times: list[Time],
        limit: int,
        total: int | None,
        by_size: bool,
        last: int,
    ) -> int:
        assert self.spec.transparency is not None
        unstuffer = self.spec.transparency.decoder()
        first = place
        behind = sum(
            part.size
            for part in self.parts[last + 1 :]
            if self.payload or not getattr(part, "when_payload", 0)
        )
        due = None if total is None else total - behind
        nothing = len(self.spec.transparency.encode(b""))
        is_empty = due is not None and due == len(content.values)

        def is_full() -> bool:
            if due is None or len(content.values) < due:
                return False
            return not is_empty or place - first >= nothing

        while place < limit and not (by_size and is_full()):
            full = is_full()
            time = times[place]
            try:
                released = unstuffer.push(self.wire[place])
            except TransparencyError as error:
                content.broken = (time, error.reason)
                return place
            if full:
                content.surplus = min(content.surplus, time)
            place += 1
            for value in released:
                if due is not None and len(content.values) >= due:
                    content.surplus = min(content.surplus, time)
                content.put(value, time, place)
        if by_size and is_full():
            content.region_end = place
            try:
                unstuffer.finish()
            except TransparencyError as error:
                content.broken = (times[place - 1], error.reason)
        return place

    def finish(self, content: _Content, limit: int, time: int) -> str | None:
        """End the region behind `limit` wire bytes. Why it may not end there, if it may not."""
        stuffed = [i for i, part in enumerate(self.parts) if part.name in self.spec.stuffed]
        raw = sum(part.size for part in self.parts[: stuffed[0]]) if stuffed else 0
        if not stuffed or limit < raw:
            return None
        assert self.spec.transparency is not None
        unstuffer = self.spec.transparency.decoder()
        try:
            for byte in self.wire[raw:limit]:
                unstuffer.push(byte)
            for value in unstuffer.finish():
                content.put(value, (time, -1), limit)
        except TransparencyError as error:
            return error.reason
        return None

    # --- the parts in front of the payload -------------------------------------------------------

    def read_head(self, content: _Content) -> int | None:
        """Read what can be read. The wire byte behind the head, if the head is there."""
        place = 0
        for part in self.head:
            if not self.read_part(part, content, place):
                return None
            place += part.size
        if not [part for part in self.head if isinstance(part, rt.IdentityPart)]:
            self.identify()
        return content.wire_ends[place - 1] if place else 0

    def read_part(self, part: Any, content: _Content, place: int) -> bool:
        """False: the part is not complete, or proves the candidate wrong."""
        data = content.values[place : place + part.size]
        if isinstance(part, rt.LiteralPart):
            for index, value in enumerate(data):
                if value != part.value[index]:
                    self.fails(content.times[place + index], CONTENT, "value")
                    return False
        if len(data) < part.size:
            return False
        time = content.times[place + part.size - 1]
        if isinstance(part, rt.IdentityPart | rt.LengthPart | rt.ValuePart):
            try:
                self.numbers[part.name] = part.number.decode(data)
            except ValueError as error:
                self.fails(time, CONTENT, error.reason)  # type: ignore[attr-defined]
                return False
        if getattr(part, "values", ()) and self.numbers[part.name] not in part.values:
            self.fails(time, CONTENT, "value")
            return False
        if isinstance(part, rt.LengthPart):
            return self.read_length(part, time)
        if isinstance(part, rt.IdentityPart):
            self.identify()
        return True

    def read_length(self, part: rt.LengthPart, time: int) -> bool:
        value = self.numbers[part.name]
        sizes = [
            size
            for size in range(self.spec.greatest_payload + 1)
            if self.counted(part, size) == value
        ]
        if not sizes or not part.least <= value <= part.greatest:
            self.fails(time, LENGTH, "length")
            return False
        self.payload = sizes[0]
        return True

    def counted(self, part: rt.LengthPart, payload: int) -> int:
        total = 0
        for other in self.spec.parts:
            if other.name in part.counts and (payload or not getattr(other, "when_payload", 0)):
                total += payload if isinstance(other, rt.PayloadPart) else other.size
        return total

    def identify(self) -> None:
        names = [part.name for part in self.head if isinstance(part, rt.IdentityPart)]
        if all(name in self.numbers for name in names):
            self.messages = candidates(self.sender, self.numbers)
            sizes = {(m.SIZES.least, m.SIZES.greatest) for m in self.messages}
            least, greatest = next(iter(sizes)) if len(sizes) == 1 else (0, 1)
            if self.length_part() is None and least == greatest:
                self.payload = least

    # --- a payload of known size -----------------------------------------------------------------

    def look_known(self, found: int | None, times: list[Time], limit: int, protected: bool) -> None:
        total = self.total()
        content = self.unstuff(
            times, limit, total, by_size=not protected or bool(self.raw_behind())
        )
        self.check_known(content)
        self.look_broken(content)
        if content.surplus[0] < NEVER:
            self.fails(content.surplus, SIZE, self.announced())
        if protected:
            self.end_known(content, found, total)
        elif len(content.values) >= total:
            self.complete_known(content, total)
        else:
            self.fails(len(self.wire), END, "truncated", size=len(self.wire))

    def raw_behind(self) -> list[Any]:
        names = [part.name for part in self.parts]
        if not self.spec.stuffed:
            return []
        return self.parts[max(names.index(name) for name in self.spec.stuffed) + 1 :]

    def check_known(self, content: _Content) -> None:
        assert self.payload is not None
        place = self.head_size
        for offset in range(self.payload if self.spec.seven_bit else 0):
            if place + offset < len(content.values) and content.values[place + offset] > 0x7F:
                self.fails(content.times[place + offset], CONTENT, "encoding")
                break
        place += self.payload
        for part in self.tail:
            if not self.payload and getattr(part, "when_payload", False):
                continue
            if not self.read_part(part, content, place):
                break
            place += part.size

    def end_known(self, content: _Content, found: int | None, total: int) -> None:
        if found is None:
            self.fails(len(self.wire), END, "truncated", size=len(self.wire))
            return
        time = found + len(self.end) - 1
        broken = self.finish(content, found, time) if not self.raw_behind() else None
        if broken:
            self.fails(time, END, broken)
        elif len(content.values) != total:
            self.fails(time, END, self.announced())
        else:
            self.close(content, total, time, found + len(self.end))

    def complete_known(self, content: _Content, total: int) -> None:
        """Exactly behind the last byte of content the end has to stand, if there is one."""
        last = content.wire_ends[total - 1] if total else 0
        last = max(last, content.region_end or 0)
        for index, byte in enumerate(self.end):
            if last + index >= len(self.wire):
                self.fails(len(self.wire), END, "truncated", size=len(self.wire))
                return
            if self.wire[last + index] != byte:
                self.fails(last + index, SIZE, self.announced())
                return
        end = last + len(self.end)
        self.close(content, total, end - 1, end)

    # --- a payload that says itself where it ends ------------------------------------------------

    def measure(self, content: _Content, times: list[Time], limit: int) -> None:
        head = self.head_size
        for size in range(len(content.values) - head + 1):
            time = content.times[head + size - 1] if head + size else (0, -1)
            if self.spec.seven_bit and size and content.values[head + size - 1] > 0x7F:
                self.fails(time, CONTENT, "encoding")
                return
            try:
                taken = prefix_size(self.messages[0].FORMAT, content.values[head : head + size], {})
            except PayloadError as error:
                if error.missing:
                    continue
                self.fails(time, CONTENT, error.reason)
                return
            assert taken == size
            self.payload = size
            self.look_known(None, times, limit, protected=False)
            return
        self.fails(len(self.wire), END, "truncated", size=len(self.wire))

    # --- a payload that only a delimiter ends ----------------------------------------------------

    def look_open(
        self,
        content: _Content,
        opened: int,
        found: int | None,
        times: list[Time],
        limit: int,
        protected: bool,
    ) -> None:
        if isinstance(self.spec.start, rt.Anywhere):
            self.fails(content.times[self.head_size - 1], SIZE, "size")
            return
        if not self.end:
            self.look_until_start(opened)
            return
        if not protected:
            found, times, limit = self.search(opened, {self.end})
            content = self.unstuff(times, limit, None)
            self.look_broken(content)
        if self.spec.seven_bit and not self.tail:
            self.check_bits(content)
        if self.messages:
            greatest = max(message.SIZES.greatest for message in self.messages)
            most = self.head_size + greatest + self.tail_size(greatest)
            if len(content.values) > most:
                self.fails(content.times[most], SIZE, "size")
        if found is None:
            self.fails(len(self.wire), END, "truncated", size=len(self.wire))
        else:
            self.close_open(content, found, found + len(self.end) - 1, found + len(self.end))

    def check_bits(self, content: _Content) -> None:
        for place in range(self.head_size, len(content.values)):
            if content.values[place] > 0x7F:
                self.fails(content.times[place], CONTENT, "encoding")
                return

    def look_until_start(self, opened: int) -> None:
        place = self.start_behind(opened)
        size = max(self.mark_size, 1)
        if place == NEVER:
            place, time = len(self.wire), len(self.wire)
        else:
            time = place + size - 1
        # What is held at the end of the input is no start.
        held_until = self.search(opened, self.marks)[1]
        times = [(min(when, len(self.wire)), index) for when, index in held_until]
        content = self.unstuff(times, min(place, len(self.wire)), None)
        self.look_broken(content)
        if self.spec.seven_bit and not self.tail:
            self.check_bits(content)
        self.close_open(content, place, time, place)

    def close_open(self, content: _Content, place: int, time: int, end: int) -> None:
        """The content ends in front of `place` on the wire; the frame has `end` bytes."""
        broken = self.finish(content, place, time)
        if broken:
            self.fails(time, END, broken, size=end)
            return
        extra = len(content.values) - self.head_size
        sizes = [size for size in range(extra + 1) if size + self.tail_size(size) == extra]
        if not sizes:
            self.fails(time, END, "truncated", size=end)
            return
        self.payload = sizes[0]
        start = self.head_size + self.payload
        if self.spec.seven_bit and not content.values[self.head_size : start].isascii():
            self.fails(time, END, "encoding", size=end)
            return
        before = len(self.happenings)
        for part in self.tail:
            if self.payload or not getattr(part, "when_payload", False):
                self.read_part(part, content, start)
                start += part.size
        wrong = self.happenings[before:]
        del self.happenings[before:]
        if wrong:
            reason = wrong[0][2].reason  # type: ignore[union-attr]
            self.fails(time, END, reason, size=end)
            return
        self.close(content, len(content.values), time, end)

    def close_early(self, content: _Content, found: int | None) -> None:
        """The candidate ends in front of its payload, unless something else happens."""
        if found is None:
            self.fails(len(self.wire), END, "truncated", size=len(self.wire))
            return
        time = found + len(self.end) - 1
        self.fails(time, END, self.finish(content, found, time) or "truncated")

    # --- complete frames -------------------------------------------------------------------------

    def close(self, content: _Content, total: int, time: int, end: int) -> None:
        assert self.payload is not None
        places: dict[str, tuple[int, int]] = {}
        start = 0
        for part in self.parts:
            if not self.payload and getattr(part, "when_payload", False):
                continue
            size = self.payload if isinstance(part, rt.PayloadPart) else part.size
            places[part.name] = (start, start + size)
            start += size
        assert start == total
        for part in self.parts:
            if isinstance(part, rt.ChecksumPart) and part.name in places:
                covered = b"".join(self.covered(part, content, places))
                low, high = places[part.name]
                if part.number.decode(content.values[low:high]) != part.algorithm.compute(covered):
                    self.happenings.append(((time, NEVER), COMPLETE, Fails(end, "checksum")))
                    return
        payload = content.values[self.head_size : self.head_size + self.payload]
        self.happenings.append(((time, NEVER), COMPLETE, Frames(end, dict(self.numbers), payload)))

    def covered(
        self, part: Any, content: _Content, places: dict[str, tuple[int, int]]
    ) -> Iterator[bytes]:
        for name in part.covers:
            low, high = places.get(name, (0, 0))
            if low == high:
                continue
            if part.over_wire:
                first = content.wire_ends[low - 1] if low else 0
                yield self.wire[first : content.wire_ends[high - 1]]
            else:
                yield content.values[low:high]
