"""Functions that take a frame which is there as a whole, with its places and bounds as constants.

One is printed for frames without rare things. It refuses what is odd in any way, as the runtime
has others for that, so that it has no more to say than where everything is.
"""

from __future__ import annotations

from collections.abc import Mapping

from protogen.model.frame_places import Place, PlacedPart, Run
from protogen.model.frame_plan import FramePlan
from protogen.model.part_plans import ChecksumPlan
from protogen.model.parts import (
    BitsPart,
    ChoicePart,
    LengthPart,
    LiteralPart,
    NumberPart,
    Part,
    TypedPart,
)
from protogen.model.protocol import Sender
from protogen.model.transparency import Escape, Substitution
from protogen.model.types import Integer
from protogen.targets.braces import BracedLines
from protogen.targets.naming import Thing
from protogen.targets.typescript.literals import Code, call, integer, is_big, literal
from protogen.targets.typescript.names import locals_table

_VIEWED = {8: "Uint8", 16: "Uint16", 32: "Uint32", 64: "BigUint64"}
"""What a `DataView` reads, by the bits."""


def is_taken_at_once(plan: FramePlan) -> bool:
    """True if a function is printed for such frames."""
    parts, region = [item.part for item in (*plan.head, *plan.tail)], plan.region
    is_odd = any(part.is_optional or not _is_simple(part) for part in parts)
    is_fitted = plan.is_cut or plan.frame.payload.kept is not None
    needs_more = plan.virtual or plan.further_lengths or plan.shares_delimiter or is_fitted
    is_listed = region is None or (
        isinstance(region.encoding, Substitution | Escape) and not (region.lenient or region.behind)
    )
    sums_one = all(map(_sums_one_run, plan.checksums))
    fixed = any(sizes.fixed is not None for group in plan.groups for sizes in group.sizes)
    tells_size = plan.length is not None or fixed
    plain = plan.takes_whole and is_listed and sums_one and tells_size
    return plain and not (is_odd or needs_more)


def _is_simple(part: Part) -> bool:
    """True if a part is no number, or one of whole bytes."""
    if not isinstance(part, TypedPart):
        return True
    return not isinstance(part, BitsPart) and _plain(part.type, "") is not None


def _sums_one_run(plan: ChecksumPlan) -> bool:
    """True if a checksum runs over one run of content."""
    is_run = len(plan.covers) == 1 and isinstance(plan.covers[0], Run)
    return is_run and not plan.part.over_wire


class AtOnce:
    """Prints the function of a sender, which has the values of parts in the order of `slots`."""

    def __init__(self, sender: Sender, slots: Mapping[str, int]) -> None:
        self._plan: FramePlan = sender.plan
        self._greatest = sender.framing.payload.greatest
        self._slots = slots
        self._lines = BracedLines(2, 2)
        self._locals = locals_table()
        self._values: dict[str, str] = {}
        """Variables, by the parts whose values they have."""

    def text(self) -> Code:
        """The function, of the runtime's `AtOnce` and the place of a frame."""
        plan = self._plan
        self._begin()
        for item in plan.head:
            if isinstance(item.part, LiteralPart):
                places = enumerate(item.part.bytes, item.offset)
                self._refuse(*(f"{self._byte(place)} !== {byte}" for place, byte in places))
            elif isinstance(item.part, NumberPart):
                self._number(item)
        names = sorted(self._slots, key=self._slots.__getitem__)
        values = f"[{', '.join(self._values[name] for name in names)}]"
        self._lines.add(f"const values = {values};", "const group = f.group(values);")
        self._end()
        self._check()
        self._lines.add(f"return f.event(values, group, {self._place(plan.head_size)}, end);")
        return Code("\n".join(["(f, at) => {", *self._lines.lines, "  }"]))

    def _begin(self) -> None:
        """Print what takes the parts that are there in any frame."""
        plan, region = self._plan, self._plan.region
        least = plan.head_size + plan.payload.least + plan.tail_size
        if region is None:
            self._refuse(f"!f.reach({self._place(least)})")
        else:
            self._refuse(f"!f.begin({region.before}, {least})")
        self._lines.add(f"const {{ {'view' if region is None else 'content: view'} }} = f;")

    def _end(self) -> None:
        """Print the place behind the payload."""
        plan, length = self._plan, self._plan.length
        if length is not None:
            size, start = self._values[length.part.name], plan.head_size - length.base
        else:
            self._refuse("group === undefined", "group.fixed === null")
            size, start = "group.fixed", plan.head_size
        self._lines.add(f"const end = {self._place(start, size)};")

    def _check(self) -> None:
        """Print what holds all bytes of the frame against what they have to be."""
        plan, start = self._plan, self._place(self._plan.head_size)
        behind = _behind("end", plan.tail_size)
        tests = [f"!f.{'fill' if plan.region else 'reach'}({behind})"]
        if plan.seven_bit:
            tests.append(f"!f.isSevenBit({start}, end)")
        marks = [word[-1] for word in plan.start_words if plan.start_is_unique]
        marks += plan.end_bytes[-1:] if plan.end_is_unique else b""
        first = len(plan.start_words[0]) if plan.start_words else 0
        is_payload = first == plan.head_size and not plan.tail_size
        is_known = plan.seven_bit and is_payload and min(marks, default=128) > 127
        if marks and plan.region is None and not is_known:
            tests.append(f"!f.isClear({self._place(first)}, {behind})")
        for index, item in enumerate(plan.checksums):
            (run,) = item.covers
            assert isinstance(run, Run)
            found = _plain(item.part.type, self._at(item.placed.place))
            due = call("f.sum", index, self._at(run.first), self._at(run.end))
            tests.append(f"{found} !== {due}")
        self._refuse(*tests)

    # --- places and numbers -----------------------------------------------------------------------

    def _place(self, offset: int, *more: str) -> Code:
        """A place so many bytes behind the first one."""
        base = [] if self._plan.region else ["at"]
        return _behind(" + ".join([*base, *more]), offset)

    def _at(self, place: Place) -> Code:
        return _behind("end", place.offset) if place.is_tail else self._place(place.offset)

    def _refuse(self, *tests: str) -> None:
        self._lines.add(f"if ({' || '.join(tests)}) return null;")

    def _number(self, item: PlacedPart) -> None:
        """Print the variable of a part, and what refuses values that it can't have."""
        part = item.part
        assert isinstance(part, NumberPart)
        name = self._locals.add(part.name, Thing("variable", ("local", part.name)))
        self._values[part.name] = name
        self._lines.add(f"const {name} = {_plain(part.type, self._place(item.offset))};")
        if test := self._wrong(item, name):
            self._refuse(test)

    def _byte(self, place: int) -> Code:
        return call("view.getUint8", self._place(place))

    def _wrong(self, item: PlacedPart, name: str) -> str:
        """What is true of a value that the part can't have; empty where it can have all."""
        part = item.part
        assert isinstance(part, NumberPart)
        if isinstance(part, ChoicePart):
            return " && ".join(f"{name} !== {_spelled(part, value)}" for value in part.values)
        least, greatest = part.least, part.greatest
        if isinstance(part, LengthPart):
            length = self._plan.counted(part)
            least = max(least, length.base)
            greatest = min(length.greatest, length.base + self._greatest)
        elif item not in self._plan.bounded:
            return ""
        tests = [f"{name} < {_spelled(part, least)}"] if least > 0 else []
        if greatest < part.type.greatest:
            tests.append(f"{name} > {_spelled(part, greatest)}")
        return " || ".join(tests)


def _plain(type_: Integer, place: str) -> Code | None:
    """The expression of a number of whole bytes; None of another one."""
    if type_.byte_bits == 7 or type_.is_text or type_.text or type_.bits not in _VIEWED:
        return None
    is_little = type_.size > 1 and type_.byte_order == "little"
    return call(f"view.get{_VIEWED[type_.bits]}", Code(place), is_little or None)


def _behind(place: str, offset: int) -> Code:
    """A place so many bytes behind another one; without one, behind the first byte."""
    if not place:
        return Code(str(offset))
    sign = "-" if offset < 0 else "+"
    return Code(f"{place} {sign} {abs(offset)}" if offset else place)


def _spelled(part: NumberPart, value: int) -> Code:
    shown = part.shown(value)
    return literal(shown if isinstance(shown, str) else integer(shown, big=is_big(part.type.bits)))
