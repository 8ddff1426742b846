"""Frames of every shape, with what has to hold so that a receiver can cut them."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from hypothesis import strategies as st

from protogen.copying import replace
from schema_fuzzing import forms
from schema_fuzzing.codes import BYTE, Code, codes, plain
from schema_fuzzing.delimiters import Delimited, Stretch
from schema_fuzzing.parts import Maker, PartPlan

STARTS = ("literal", "literal", "two literals", "choice", "set", "none")
_BYTE_BY_BYTE = (
    "substitute", "insertion", "escape-invert", "escape-none", "escape-xor", "slip", "hdlc",
)  # fmt: skip
ENDS = ("literal", "two literals", "none", "none")
_EVERY_COBS_BYTE = frozenset(bytes((byte,)) for byte in range(1, 256))


@dataclass(frozen=True, slots=True)
class Region:
    """The parts under transparency, by index; `written` as in the schema."""

    first: int
    last: int
    written: bool


@dataclass(frozen=True, slots=True)
class FramePlan:
    """A frame that was drawn, but for what depends on the messages."""

    parts: tuple[PartPlan, ...]
    code: Code | None
    region: Region | None
    lenient: bool = False
    room: int | None = None
    """The greatest payload that the length part and the greatest size leave."""
    limit: int | None = None
    """The greatest size on the wire, if that is stated."""
    spare: int | None = None
    """A payload that surely fits that, however it is stuffed."""
    silence: PartPlan | None = None
    """What ends the frame, where only a silence does."""
    stuffing: Mapping[str, Any] = field(default_factory=dict)
    """What is said of the transparency: what it covers, and texts."""

    @property
    def surely(self) -> int | None:
        """The greatest payload of which no frame is too long; None where nothing bounds it."""
        return self.room if self.spare is None else self.spare

    @property
    def opening(self) -> tuple[int, ...]:
        """The literals that the frame starts with, outside of the region."""
        edge = None if self.region is None else self.region.first
        if self.parts[0].role == "choice":
            return () if edge == 0 else (0,)
        return tuple(self._literals_from(0, 1, edge))

    @property
    def closing(self) -> tuple[int, ...]:
        """The literals that the frame ends with, outside of the region."""
        last = len(self.parts) - 1
        edge = None if self.region is None else self.region.last
        return tuple(self._literals_from(last, -1, edge))[::-1]

    def _literals_from(self, index: int, step: int, edge: int | None) -> Iterator[int]:
        while 0 <= index < len(self.parts) and self.parts[index].role == "literal":
            if index == edge:
                return
            yield index
            index += step

    @property
    def delimited(self) -> bool:
        """True if the frame tells where the payload ends."""
        has_length = any(part.role == "length" for part in self.parts)
        return bool(self.closing) or has_length or self.silence is not None

    @property
    def has_length(self) -> bool:
        """True if a part says how long the payload is."""
        return any(part.role == "length" for part in self.parts)

    def trimmed(self) -> FramePlan:
        """The same frame, with a payload whose zeros at the end are left out."""
        return self._with_payload(trailing_zeros="trimmed")

    def cut(self) -> FramePlan:
        """The same frame, with a payload that may be longer than its message."""
        return self._with_payload(longer="cut")

    @property
    def is_cut(self) -> bool:
        """True if newer senders may have anything behind the fields of a payload."""
        return any("longer" in part.data for part in self.parts)

    def _with_payload(self, **keys: str) -> FramePlan:
        parts = (part.adding(**keys) if part.role == "payload" else part for part in self.parts)
        return replace(self, parts=tuple(parts))

    @property
    def starts_with_set(self) -> bool:
        """True if the range of the first part marks the start."""
        covered = self.region is not None and self.region.first == 0
        return not self.opening and "range" in self.parts[0].data and not covered

    def words_at(self, places: Sequence[int]) -> tuple[bytes, ...]:
        """Literals that stand side by side, joined; or each that there is a choice of."""
        first = self.parts[places[0]]
        return first.words or (b"".join(self.parts[index].literal for index in places),)

    # -- what depends on the messages --------------------------------------------------------

    def with_least_payload(self, least: int, slack: int) -> FramePlan:
        """The frame whose length says at least what the smallest payload needs, less `slack`."""
        parts = tuple(_with_least(part, least, slack) for part in self.parts)
        lengths = [part for part in parts if part.role == "length"]
        if len(lengths) > 1 and least > slack and any("range" in part.data for part in lengths):
            parts = tuple(
                _agreeing(part, least - slack, None) if part.role == "length" else part
                for part in parts
            )
        return replace(self, parts=parts)

    def stretches(self, payload: frozenset[int], own: Sequence[int]) -> Iterator[Stretch]:
        """Bytes of the frame on the wire, where the payload holds such bytes."""
        for index, part in enumerate(self.parts):
            inside = self.region is not None and self.region.first <= index <= self.region.last
            if inside and self.code is not None and self.code.codewords is None:
                if self.region is not None and index == self.region.first:
                    yield Stretch(_EVERY_COBS_BYTE)
                    yield Stretch(_EVERY_COBS_BYTE, repeated=True)
                continue
            words = plain()
            if inside and self.code is not None and self.code.codewords is not None:
                words = dict(self.code.codewords)
            own_place = index in own
            for stretch in _stretches_of(part, words, payload, own=own_place):
                inserted = self.code.inserted if inside and self.code is not None else b""
                yield replace(stretch, inserted=inserted)

    def with_unprotected(self, payload: frozenset[int], decision: str) -> FramePlan:
        """The frame with `unprotected` on the delimiters that can occur in the data."""
        parts = list(self.parts)
        has_choice = any(self.parts[place].words for place in self.opening)
        for places in (self.opening, self.closing):
            own = places if has_choice else (*self.opening, *self.closing)
            automaton = Delimited(self.stretches(payload, own))
            if places and any(map(automaton.holds, self.words_at(places))):
                parts[places[-1]] = parts[places[-1]].adding(unprotected=decision)
        if self._is_unmarked:
            parts[0] = parts[0].adding(unprotected=decision)
        return replace(self, parts=tuple(parts))

    @property
    def _is_unmarked(self) -> bool:
        """True if nothing marks where a frame starts, and no checksum tells."""
        checked = any(part.role == "checksum" and not part.optional for part in self.parts)
        return not (self.opening or self.closing or self.starts_with_set or checked)

    # -- as it is written --------------------------------------------------------------------

    def data(self) -> dict[str, Any]:
        """The frame in the schema language."""
        silence = () if self.silence is None else (self.silence,)
        return {part.name: part.data for part in (*self.parts, *silence)}

    def transparency(self) -> Any:
        """The transparency in the schema language, or None."""
        if self.code is None or self.region is None:
            return None
        if not (self.lenient or self.stuffing):
            return self.code.data
        data = self.code.data
        full = {"preset": data} if isinstance(data, str) else dict(data)
        if self.lenient:
            full["lenient"] = True
        full.update(self.stuffing)
        return full


def _with_least(part: PartPlan, least: int, slack: int) -> PartPlan:
    if part.role != "length" or "range" not in part.data or "over" in part.data:
        return part
    assert part.type is not None
    counted, greatest = part.bounds
    low = max(0, counted + least - slack)
    values = part.type.bytes_between(low, greatest)
    return replace(part.adding(range=[low, part.data["range"][1]]), values=values)


def _agreeing(part: PartPlan, least: int, greatest: int | None) -> PartPlan:
    """A length that others bound to payloads of such sizes; None: of any that it can say."""
    assert part.type is not None
    counted, most = part.bounds
    most = most if greatest is None else counted + greatest
    values = part.type.bytes_between(counted + least if least else 0, most)
    return replace(part, values=values, bounds=(counted, most))


def _stretches_of(
    part: PartPlan, words: dict[int, bytes], payload: frozenset[int], *, own: bool
) -> Iterator[Stretch]:
    if part.role == "payload":
        yield Stretch(frozenset(words[byte] for byte in payload), repeated=True)
    elif part.role == "literal":
        yield Stretch(frozenset({b"".join(words[byte] for byte in part.literal)}), own=own)
    elif part.role == "choice":
        found = (b"".join(words[byte] for byte in literal) for literal in part.words)
        yield Stretch(frozenset(found), own=own)
    else:
        for values in part.values:
            found = frozenset(words[byte] for byte in values)
            yield Stretch(found, optional=part.optional)


# --- drawing ------------------------------------------------------------------------------------


@st.composite
def frames(
    draw: st.DrawFn,
    byte_bits: int,
    order: str | None,
    identity: Sequence[PartPlan],
    payload: frozenset[int],
    beside: FramePlan | None = None,
) -> FramePlan:
    """A frame for such payload bytes, sometimes one that goes together with another form.

    What its length can say at least and its `unprotected` keys are still missing.
    """
    return _Drawing(draw, byte_bits, order, identity, payload, beside).frame()


class _Drawing:
    """Draws one frame."""

    def __init__(
        self,
        draw: st.DrawFn,
        byte_bits: int,
        order: str | None,
        identity: Sequence[PartPlan],
        payload: frozenset[int],
        beside: FramePlan | None,
    ) -> None:
        self._draw = draw
        self._beside = beside
        self._payload = payload
        self._maker = Maker(draw, byte_bits, order)
        for part in identity:
            self._maker.take([part.name, *part.data.get("bits", ())])
        self._code = draw(codes())
        self._start = draw(st.sampled_from(STARTS))
        self._end = draw(st.sampled_from(ENDS))
        self._is_idle = self._code is None and self._end == "none" and draw(forms.one_in(3))
        if beside is not None:
            self._go_with(beside)
        self._has_length = draw(st.booleans())
        self._anywhere = self._start == self._end == "none"
        self._by_position = self._anywhere and not draw(forms.one_in(4))
        """True if a checksum is not needed."""
        self._head, self._tail = self._around_payload(list(identity))
        self._make_findable()

    def _go_with(self, beside: FramePlan) -> None:
        """Begin and end as the frames of another form do, so that one search finds both."""
        self._is_idle = beside.silence is not None
        if self._is_idle:
            self._code = None
        if beside.opening or beside.starts_with_set:
            self._start = self._draw(st.sampled_from(["literal", "two literals", "choice"]))
            self._end = "none" if self._is_idle else self._end
        else:
            self._start, self._end = "none", "literal" if beside.closing else "none"

    def frame(self) -> FramePlan:
        opening, closing = self._delimiters()
        parts = [*opening, *self._head, self._maker.payload(), *self._tail, *closing]
        region = self._region(parts, len(opening), len(closing))
        parts, room = self._with_length(parts, region)
        parts = self._with_covers(parts, region)
        lenient = self._may_be_lenient(parts) and self._draw(forms.one_in(6))
        spare = self._spare(parts, region, room)
        plan = FramePlan(tuple(parts), self._code, region, lenient, room, spare=spare)
        plan = replace(plan, stuffing=self._stuffing(parts, region))
        if self._is_idle:
            idle = {"idle": self._draw(st.sampled_from(["4 ms", "500us", "1.75 ms", "2 s"]))}
            plan = replace(plan, silence=PartPlan(self._maker.name(), "silence", idle))
            return self._limited(plan)
        return self._limited(plan) if self._draw(forms.one_in(4)) else plan

    def _stuffing(self, parts: Sequence[PartPlan], region: Region | None) -> dict[str, Any]:
        if region is None:
            return {}
        keys: dict[str, Any] = dict(self._draw(forms.about()))
        if region.written:
            names = [part.name for part in parts]
            keys["covers"] = self._draw(forms.run(names[region.first : region.last + 1], names))
        return keys

    def _may_be_lenient(self, parts: list[PartPlan]) -> bool:
        counts_wire = any(part.role == "length" and "over" in part.data for part in parts)
        return self._code is not None and not self._code.inserted and not counts_wire

    # -- delimiters --------------------------------------------------------------------------

    def _delimiters(self) -> tuple[list[PartPlan], list[PartPlan]]:
        opening = [self._literal() for _ in range(_literals(self._start))]
        if self._start == "choice":
            opening = [self._choice(self._delimiter_byte)]
        closing = [self._literal() for _ in range(_literals(self._end))]
        if self._start == "none" and closing and self._beside is not None:
            places = self._beside.closing
            end = b"".join(self._beside.parts[place].literal for place in places)
            closing = [self._maker.literal(end)]
        sizes = (len(opening), len(closing))
        alike = sizes == (1, 1) and not opening[0].words and self._draw(forms.one_in(3))
        if alike:
            closing = [self._maker.literal(opening[0].literal)]
        if self._start == "choice":
            return opening, closing
        if _joined(opening) == _joined(closing) and not self._is_never_empty():
            return opening, []  # Nothing could stand between them, and that is no frame.
        return opening, closing

    def _literal(self) -> PartPlan:
        size = self._draw(st.sampled_from([1, 1, 1, 2, 2, 3]))
        return self._maker.literal(bytes(self._delimiter_byte() for _ in range(size)))

    def _choice(self, byte: Callable[[], int]) -> PartPlan:
        """A choice of two to four literals of such bytes."""
        size = self._draw(st.sampled_from([1, 1, 1, 2, 2, 3]))
        count = self._draw(st.integers(2, 4))
        drawn = dict.fromkeys(bytes(byte() for _ in range(size)) for _ in range(count))
        if len(drawn) < 2:
            (only,) = drawn
            drawn[only[:-1] + bytes((only[-1] ^ 0x11,))] = None
        return self._maker.choice(tuple(drawn))

    def _any_byte(self) -> int:
        return self._draw(BYTE)

    def _delimiter_byte(self) -> int:
        """Mostly a byte that is kept out of the data, where there is one."""
        if self._draw(forms.one_in(5)):
            return self._draw(BYTE)
        if self._code is not None:
            return self._draw(st.sampled_from(self._code.clean))
        return self._draw(st.sampled_from([0xFF, 0x80, 0x55, 0x0A]))

    # -- what stands around the payload ------------------------------------------------------

    def _make_findable(self) -> None:
        """Add what a receiver needs: no frame is nothing but its end; a start set tells little."""
        if self._start == "none" and not self._is_never_empty():
            self._head.append(self._maker.number("value"))
        if self._by_position and self._may_be_set():
            self._tail.append(self._maker.checksum(optional=False))
        if self._start == "set" and self._end == "none" and not self._is_set_apart():
            self._tail.append(self._maker.checksum(optional=False))

    def _may_be_set(self) -> bool:
        """True if the range of the first part may mark the start."""
        first = self._head[0] if self._head else None
        return first is not None and (first.role == "length" or "range" in first.data)

    def _is_never_empty(self) -> bool:
        """True if something stands in every frame beside its delimiters and the payload."""
        return any(not part.optional for part in (*self._head, *self._tail))

    def _is_set_apart(self) -> bool:
        """True if the first part tells by its range alone where a frame starts."""
        others = [values for part in (*self._head[1:], *self._tail) for values in part.values]
        used = frozenset().union(self._payload, *others)
        marks = self._head[0].values[0]
        told = self._has_length or marks.isdisjoint(used)
        return self._code is None and told and not used <= marks

    def _around_payload(self, identity: list[PartPlan]) -> tuple[list[PartPlan], list[PartPlan]]:
        draw, maker = self._draw, self._maker
        tail = [maker.number("value")] if draw(forms.one_in(6)) else []
        late = self._has_length or self._end != "none" or self._is_idle
        if len(identity) > 1 and late and draw(forms.one_in(4)):
            tail.append(identity.pop())
        others = [maker.number(draw(st.sampled_from(["counter", "value"])))
                  for _ in range(draw(st.sampled_from([0, 0, 0, 1, 1, 2])))]  # fmt: skip
        if self._has_length:
            others.append(PartPlan(maker.name(), "length"))
            if draw(forms.one_in(4)):
                draw(st.sampled_from([others, others, tail])).append(
                    PartPlan(maker.name(), "length")
                )
        sums = self._checksums()
        if sums and not self._anywhere and draw(forms.one_in(6)):
            others.append(maker.checksum(optional=False))
            sums.pop()
        head = self._mixed(identity, others)
        if self._start == "set" and not (head and head[0].data.get("range") and head[0].size == 1):
            head.insert(0, maker.number("value", start=True))
        elif head and "bits" in head[0].data and self._start == "none":
            head.insert(0, maker.number("counter"))  # Bits might mark a start.
        self._mirror(head)
        self._mirror(tail)
        tail += sums
        self._mark(head, tail)
        return head, tail

    def _mirror(self, parts: list[PartPlan]) -> None:
        """Put in what follows from some of the parts, behind them, sometimes."""
        for part in [part for part in parts if part.can_be_mirrored]:
            if self._draw(forms.one_in(6)):
                place = self._draw(st.integers(parts.index(part) + 1, len(parts)))
                parts.insert(place, self._maker.mirror(part))

    def _checksums(self) -> list[PartPlan]:
        count = self._draw(st.sampled_from([0, 1, 1, 2]))
        if self._by_position:
            count = min(1, count)
        elif self._anywhere:
            count = max(1, count)
        return [self._maker.checksum(optional=self._is_optional()) for _ in range(count)]

    def _is_optional(self) -> bool:
        """True if a checksum may be absent: it is, where nothing has to tell a frame."""
        return self._by_position or (not self._anywhere and self._draw(forms.one_in(5)))

    def _mixed(self, identity: list[PartPlan], others: list[PartPlan]) -> list[PartPlan]:
        """The identity parts in their order, with the others before, between and behind."""
        head = list(identity)
        fixed = 1 if self._start == "set" and identity else 0
        for part in others:
            head.insert(self._draw(st.integers(min(fixed, len(head)), len(head))), part)
        return head

    def _mark(self, head: list[PartPlan], tail: list[PartPlan]) -> None:
        """Put a literal between other parts, sometimes."""
        if self._draw(forms.one_in(8)) and head:
            place = self._draw(st.integers(1, len(head)))
            head.insert(place, self._maker.literal(self._draw(st.binary(min_size=1, max_size=2))))
        if self._draw(forms.one_in(10)) and head:
            head.insert(self._draw(st.integers(1, len(head))), self._choice(self._any_byte))
        if self._draw(forms.one_in(12)) and tail:
            tail.insert(0, self._choice(self._any_byte))
        if self._draw(forms.one_in(10)) and tail:
            tail.insert(0, self._maker.literal(self._draw(st.binary(min_size=1, max_size=2))))

    # -- the region --------------------------------------------------------------------------

    def _region(self, parts: list[PartPlan], opening: int, closing: int) -> Region | None:
        """The parts under transparency: nothing but the end literal may follow without a length."""
        if self._code is None:
            return None
        first, last = opening, len(parts) - closing - 1
        if self._start != "set" and self._draw(st.booleans()):
            return Region(first, last, written=False)
        payload = next(i for i, part in enumerate(parts) if part.role == "payload")
        length = next((i for i, part in enumerate(parts) if part.role == "length"), payload)
        if self._code.codewords is not None and length < payload and self._draw(forms.one_in(3)):
            return Region(self._draw(st.integers(length + 1, payload)), payload, written=True)
        earliest = first + (self._start == "set")
        first = self._draw(st.integers(min(earliest, payload), payload))
        if self._has_length:
            last = self._draw(st.integers(payload, last))
            if self._draw(forms.one_in(10)):
                last = self._draw(st.integers(first, last))
        return Region(first, last, written=True)

    # -- lengths -----------------------------------------------------------------------------

    def _may_count_wire(self, parts: list[PartPlan], place: int, region: Region | None) -> bool:
        """True if a length can count what is sent: the payload is stuffed, it and sums are not."""
        if self._code is None or self._code.kind not in _BYTE_BY_BYTE or region is None:
            return False
        inside = parts[region.first : region.last + 1]
        roles = {part.role for part in inside}
        is_optional = any(part.optional for part in parts)
        return (
            place < region.first and "payload" in roles and not ("checksum" in roles or is_optional)
        )

    def _spare(self, parts: list[PartPlan], region: Region | None, room: int | None) -> int | None:
        """A payload that a length over the wire can surely state; None where it counts none."""
        length = next((part for part in parts if part.role == "length"), None)
        if length is None or "over" not in length.data or region is None or room is None:
            return None
        assert self._code is not None
        others = sum(part.size for part in parts[region.first : region.last + 1])
        if self._code.inserted:
            return max(0, (room + others) * 2 // 3 - others)
        longest = max(len(word) for word in (self._code.codewords or {}).values())
        return max(0, (room + others) // longest - others)

    def _with_length(
        self, parts: list[PartPlan], region: Region | None
    ) -> tuple[list[PartPlan], int | None]:
        """The length part with its type, now that it is known what it can count."""
        places = [i for i, part in enumerate(parts) if part.role == "length"]
        if not places:
            return parts, None
        if len(places) > 1:
            return self._with_lengths(parts, places)
        place = places[0]
        itself = self._draw(st.booleans())
        counts_wire = self._may_count_wire(parts, place, region) and self._draw(st.booleans())
        stuffed = range(region.first, region.last + 1) if counts_wire and region else ()
        others = [
            part for index, part in enumerate(parts)
            if part.role not in ("payload", "length") and not part.optional
            and (index in stuffed or self._draw(st.booleans()))
        ]  # fmt: skip
        counted = sum(part.size for part in others)
        type_, keys = self._maker.type(least_greatest=counted + (72 if counts_wire else 18))
        counted += type_.size if itself else 0
        names = {part.name for part in others} | {"payload"}
        names |= {parts[place].name} if itself else set()
        every = [part.name for part in parts]
        keys["counts"] = self._draw(forms.run([n for n in every if n in names], every))
        greatest = type_.greatest
        if greatest > 1000 or self._draw(st.booleans()):
            rooms = [60, 300] if counts_wire else [8, 20, 60, 300]
            greatest = min(greatest, counted + self._draw(st.sampled_from(rooms)))
            keys["range"] = [0, greatest]
        if counts_wire:
            keys["over"] = "wire"
        keys.update(self._draw(forms.about()))
        values = type_.bytes_between(0, greatest)
        bounds = (counted, greatest)
        part = PartPlan(parts[place].name, "length", keys, values, type=type_, bounds=bounds)
        found = [part]
        if region is None and type_.digits is None and "range" not in keys:
            # Where parts have no places yet that one more would move.
            found += [self._maker.mirror(part)] if self._draw(forms.one_in(2)) else []
        if len(found) == 1 and place > 0 and keys.keys().isdisjoint({"range", "over"}):
            part = self._maker.length_in_bits(part) if self._draw(forms.one_in(2)) else part
            found, greatest = [part], part.bounds[1]
        return [*parts[:place], *found, *parts[place + 1 :]], greatest - counted

    def _with_lengths(
        self, parts: list[PartPlan], places: Sequence[int]
    ) -> tuple[list[PartPlan], int]:
        """Several lengths, which may count those that were drawn before them."""
        found, every = list(parts), [part.name for part in parts]
        for place in places:
            others = [part for part in found if part.values and not part.optional]
            counted = [part for part in others if self._draw(st.booleans())]
            names = {part.name for part in counted} | {"payload"}
            size = sum(part.size for part in counted)
            type_, keys = self._maker.type(least_greatest=size + 18)
            if self._draw(st.booleans()):
                names.add(every[place])
                size += type_.size
            keys["counts"] = self._draw(forms.run([n for n in every if n in names], every))
            greatest = type_.greatest
            if greatest > 1000 or self._draw(st.booleans()):
                greatest = min(greatest, size + self._draw(st.sampled_from([8, 20, 60, 300])))
                keys["range"] = [0, greatest]
            keys.update(self._draw(forms.about()))
            values, bounds = type_.bytes_between(0, greatest), (size, greatest)
            found[place] = PartPlan(every[place], "length", keys, values, type=type_, bounds=bounds)
        room = min(greatest - counted for counted, greatest in (found[i].bounds for i in places))
        for place in places:
            found[place] = _agreeing(found[place], 0, room)
        return found, room

    # -- the greatest size -------------------------------------------------------------------

    def _limited(self, plan: FramePlan) -> FramePlan:
        """The frame with a greatest size, which has room for some payload."""
        spare = min(self._draw(st.integers(4, 40)), 1000 if plan.surely is None else plan.surely)
        least, greatest = _around(plan)
        each_least, each_greatest = _lengths(_words(plan, "payload"), frozenset(range(256)))
        limit = greatest + spare * each_greatest
        if plan.code is not None and plan.code.codewords is None:
            limit += (greatest + spare) // 254
        if plan.code is not None and plan.code.inserted:
            limit += (greatest + spare) // 2
        room = (limit - least) // each_least
        room = room if plan.room is None else min(room, plan.room)
        return replace(plan, limit=limit, room=room, spare=spare)

    # -- checksums ---------------------------------------------------------------------------

    def _with_covers(self, parts: list[PartPlan], region: Region | None) -> list[PartPlan]:
        """The checksums with what they cover: never each other in a circle."""
        every = [part.name for part in parts]
        seen: list[str] = []
        found = list(parts)
        for index, part in enumerate(parts):
            if part.role != "checksum":
                continue
            allowed = [p.name for p in parts if p.role != "checksum" or p.name in seen]
            covered = self._covered(allowed, every, index)
            keys = {"covers": self._draw(forms.run(covered, every))}
            seen.append(part.name)
            if part.sum_bits:
                found[index] = part.adding_to_bits(part.sum_bits, **keys)
                continue
            places = {every.index(name) for name in covered}
            if self._may_be_over_wire(places, region) and self._draw(forms.one_in(4)):
                keys["over"] = "wire"
            elif self._draw(forms.one_in(4)):
                keys["over"] = "content"
            found[index] = found[index].adding(**keys)
        return found

    def _covered(self, allowed: list[str], every: list[str], index: int) -> list[str]:
        """Some of the allowed parts: all before the checksum, the payload, or any."""
        before = [name for name in every[:index] if name in allowed]
        choice = self._draw(st.sampled_from(["before", "payload", "any"]))
        if before and (self._anywhere or choice == "before"):
            return before
        if choice == "payload":
            return ["payload"]
        chosen = self._draw(st.sets(st.sampled_from(allowed), min_size=1))
        return [name for name in every if name in chosen]

    def _may_be_over_wire(self, places: set[int], region: Region | None) -> bool:
        """COBS bytes belong to no part, so that none can be covered; of sequences all, or none."""
        if region is None or self._code is None:
            return True
        if self._code.inserted and places >= {*range(region.first, region.last + 1)}:
            return True
        if self._code.codewords is not None and not self._code.inserted:
            return True
        return places.isdisjoint(range(region.first, region.last + 1))


def _words(plan: FramePlan, part: str) -> Mapping[int, bytes]:
    """The codewords of the bytes of a part; those of COBS have the size of the bytes."""
    if plan.region is None or plan.code is None or plan.code.codewords is None:
        return plain()
    inside = plan.parts[plan.region.first : plan.region.last + 1]
    return plan.code.codewords if part in {item.name for item in inside} else plain()


def _lengths(words: Mapping[int, bytes], values: frozenset[int]) -> tuple[int, int]:
    """The fewest and the most bytes that stand for one of these."""
    sizes = [len(words[value]) for value in values]
    return min(sizes), max(sizes)


def _around(plan: FramePlan) -> tuple[int, int]:
    """The fewest and the most bytes on the wire around a payload that is not empty."""
    pairs = [
        _lengths(_words(plan, part.name), values) for part in plan.parts for values in part.values
    ]
    codes = int(plan.code is not None and plan.code.codewords is None)
    return sum(low for low, _ in pairs) + codes, sum(high for _, high in pairs) + codes


def _joined(literals: Sequence[PartPlan]) -> bytes:
    return b"".join(part.literal for part in literals)


def _literals(shape: str) -> int:
    return {"literal": 1, "two literals": 2}.get(shape, 0)
