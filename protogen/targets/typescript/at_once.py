"""Functions that take a frame which is there as a whole, with its places and bounds as constants.

One is printed for frames without rare things. It refuses what is odd in any way, as the runtime
has others for that, so that it has no more to say than where everything is.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from itertools import groupby

from protogen.model.checksums import ChecksumSpec
from protogen.model.frame_places import Place, PlacedPart
from protogen.model.frame_plan import FramePlan
from protogen.model.part_plans import StuffedRegion
from protogen.model.parts import (
    LengthPart,
    LiteralPart,
    NumberPart,
)
from protogen.model.plain_frames import (
    is_plain,
    length_bounds,
    may_contain_marks,
    summed_run,
    zero_sum_run,
)
from protogen.model.protocol import Sender
from protogen.model.types import Integer
from protogen.targets.braces import BracedLines
from protogen.targets.naming import Thing
from protogen.targets.typescript.literals import (
    GREATEST_BITS,
    Code,
    call,
)
from protogen.targets.typescript.names import locals_table


def is_taken_at_once(plan: FramePlan) -> bool:
    """True if a function is printed for such frames."""
    return is_plain(plan) and sum(it.type.bits for it in plan.frame.shown_parts) <= GREATEST_BITS


class AtOnce:
    """Prints the function of a sender."""

    def __init__(self, sender: Sender) -> None:
        self._plan: FramePlan = sender.plan
        self._greatest = sender.framing.payload.greatest
        self._lines = BracedLines(2, 2)
        self._locals = locals_table()
        self._folded = zero_sum_run(self._plan)
        self._values: dict[str, Code] = {}
        """Variables, by the parts whose values they have."""

    def text(self) -> Code:
        """The function, of the runtime's `AtOnce` and the place of a frame."""
        plan, region = self._plan, self._plan.region
        self._lines.add(f"const {{ {', '.join(self._members())} }} = f;")
        self._refuse(f"at + {plan.least} > size", *_differ("data", "at", plan.start_bytes))
        if region is None:
            self._numbers(plan.head)
            self._find_end()
        else:
            self._unstuff(region)
            self._numbers(item for item in plan.head if not isinstance(item.part, LengthPart))
        self._check()
        self._event()
        return Code("\n".join(["(f, at) => {", *self._lines.lines, "  }"]))

    def _members(self) -> Iterator[str]:
        """What the function needs of the runtime's object."""
        plan = self._plan
        yield from ("data", "size")
        if plan.region:
            yield "content"
        has_numbers = any(isinstance(item.part, NumberPart) for item in plan.head)
        if has_numbers or (plan.checksums and not self._folded):
            yield "view"

    # --- content that is not stuffed --------------------------------------------------------------

    def _find_end(self) -> None:
        """Print the place behind the payload, and what is looked for there and in front of it."""
        plan = self._plan
        size, start = self._sizes()
        self._lines.add(f"const end = {self._place(start, size)};")
        last = behind("end", plan.tail_size)
        room = behind("end", plan.tail_size + len(plan.end_bytes))
        tests = [f"{room} > size", *_differ("data", last, plan.end_bytes)]
        if may_contain_marks(plan):
            tests.append(f"!f.isClear({self._place(plan.start_size)}, {last})")
        self._refuse(*tests)

    def _sizes(self) -> tuple[str, int]:
        """What the payload's size is known by, and what that is less than its end."""
        plan, length = self._plan, self._plan.length
        if length is not None:
            return self._values[length.part.name], plan.head_size - length.base
        self._lines.add(f"const known = {self._known()};")
        self._refuse("known === undefined", "known.fixed === null")
        return "known.fixed", plan.head_size

    # --- content that is stuffed ------------------------------------------------------------------

    def _unstuff(self, region: StuffedRegion) -> None:
        """Print the loop that takes the stuffing off, and sums up on the way if it can."""
        plan, add, run = self._plan, self._lines.add, self._folded
        spec = plan.checksums[0].part.algorithm if run else None
        taken, head = len(plan.start_bytes), plan.head_size
        add(f"let place = {behind('at', taken)};", f"let filled = {taken};", f"let due = {head};")
        if region.before > taken:
            add(f"while (filled < {region.before}) content[filled++] = data[place++] ?? 0;")
        if spec:
            add(f"let sum = {spec.init};")
        with self._lines.block("while (filled < due)"):
            add("let byte = data[place++] ?? 0;")
            self._replace(region.codes)
            add("content[filled++] = byte;")
            if spec:
                add(adding(spec))
            with self._lines.block(f"if (filled === {head})"):
                if spec and run and run.first.offset == head:
                    add(f"sum = {spec.init};")
                self._measure()
        add(f"const end = {behind('due', -plan.tail_size)};")
        stop = behind("place", len(plan.end_bytes))
        is_wrong = ["sum & 255"] if spec else []
        self._refuse(f"{stop} > size", *_differ("data", "place", plan.end_bytes), *is_wrong)

    def _measure(self) -> None:
        """Print what the head says of the bytes of content that are due."""
        plan, length = self._plan, self._plan.length
        names = {item.name for item in plan.identity} if length is None else {length.part.name}
        self._numbers(item for item in plan.head if item.name in names)
        size, start = self._sizes()
        self._lines.add(f"due = {behind(size, start + plan.tail_size)};")

    def _replace(self, codes: Sequence[tuple[int, bytes]]) -> None:
        """Print what sequences stand for; a byte that is always replaced by one is refused."""
        self._sequences(codes)
        begun = {word[0] for _, word in codes}
        refused = [f"byte === {byte}" for byte, _ in codes if byte not in begun]
        if refused:
            self._lines.add(f"else if ({' || '.join(refused)}) return null;")

    def _sequences(self, codes: Iterable[tuple[int, bytes]]) -> None:
        """Print what a byte begins, or what it ends, of sequences or of what is left of them."""
        word = "if"
        for first, group in groupby(codes, lambda code: code[1][0]):
            ends = [(byte, rest[1:]) for byte, rest in group]
            head, word = f"{word} (byte === {first})", "else if"
            byte, rest = ends[0]
            if not rest:
                self._lines.add(f"{head} byte = {byte};")
                continue
            with self._lines.block(head):
                self._lines.add("byte = data[place++] ?? 0;")
                self._sequences(ends)
                self._lines.add("else return null;")

    # --- what both have ---------------------------------------------------------------------------

    def _numbers(self, items: Iterable[PlacedPart]) -> None:
        """Print variables of numbers, and what refuses bytes and values that parts can't have."""
        bytes_ = "content" if self._plan.region else "data"
        for item in items:
            part, place = item.part, self._place(item.offset)
            if isinstance(part, LiteralPart) and item.offset >= len(self._plan.start_bytes):
                self._refuse(*_differ(bytes_, place, part.bytes))
            elif isinstance(part, NumberPart):
                name = self._locals.add(part.name, Thing("variable", ("local", part.name)))
                self._values[part.name] = Code(name)
                self._lines.add(f"const {name} = {_plain(part.type, place)};")
                if isinstance(part, LengthPart):
                    self._refuse(*self._wrong(part, name))

    def _wrong(self, part: LengthPart, name: str) -> Iterator[str]:
        """What is true of a length that no frame has."""
        least, greatest = length_bounds(self._plan, part, self._greatest)
        if least > 0:
            yield f"{name} < {least}"
        if greatest < part.type.greatest:
            yield f"{name} > {greatest}"

    def _check(self) -> None:
        """Print what holds the payload and the checksums against what they have to be."""
        plan = self._plan
        tests = [f"!f.isSevenBit({self._place(plan.head_size)}, end)"] if plan.seven_bit else []
        for index, item in enumerate(() if self._folded else plan.checksums):
            run = summed_run(item)
            found = _plain(item.part.type, self._at(item.placed.place))
            due = call("f.sum", index, self._at(run.first), self._at(run.end))
            tests.append(f"{found} !== {due}")
        self._refuse(*tests)

    def _event(self) -> None:
        """Print what the event has, and where everything is."""
        plan = self._plan
        parts = self._joined(plan.frame.shown_parts)
        is_found = plan.region is None and plan.length is None
        known = Code("known") if is_found else self._known()
        last = behind("end", plan.tail_size) if plan.region is None else "place"
        places = self._place(plan.head_size), Code("end"), behind(last, len(plan.end_bytes))
        self._lines.add(f"return {call('f.event', parts, known, *places)};")

    def _known(self) -> Code:
        """The message of the identity."""
        return call("f.known", self._joined(self._plan.identity))

    def _joined(self, parts: Iterable[NumberPart]) -> Code:
        """The values of parts as one number, each part above those behind it."""
        number = ""
        for part in parts:
            value = self._values[part.name]
            number = f"{256**part.size} * ({number}) + {value}" if number else value
        return Code(number or "0")

    def _place(self, offset: int, *more: str) -> Code:
        """A place so many bytes behind the first one."""
        base = [] if self._plan.region else ["at"]
        return behind(" + ".join([*base, *more]), offset)

    def _at(self, place: Place) -> Code:
        return behind("end", place.offset) if place.is_tail else self._place(place.offset)

    def _refuse(self, *tests: str) -> None:
        if tests:
            self._lines.add(f"if ({' || '.join(tests)}) return null;")


def _plain(type_: Integer, place: str) -> Code:
    """The expression of a number of whole bytes."""
    is_little = type_.size > 1 and type_.byte_order == "little"
    return call(f"view.getUint{type_.bits}", Code(place), is_little or None)


def _differ(name: str, place: str, due: bytes) -> Iterator[str]:
    """What is true of each byte that is not what it has to be."""
    for offset, byte in enumerate(due):
        yield f"{name}[{behind(place, offset)}] !== {byte}"


def adding(spec: ChecksumSpec) -> str:
    """The statement that takes a byte into a sum or an exclusive or."""
    return f"sum {'^' if spec.kind == 'xor' else '+'}= byte;"


def behind(place: str, offset: int) -> Code:
    """A place so many bytes behind another one; without one, behind the first byte."""
    if not place:
        return Code(str(offset))
    sign = "-" if offset < 0 else "+"
    return Code(f"{place} {sign} {abs(offset)}" if offset else place)
