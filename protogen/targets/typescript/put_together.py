"""Functions that put a frame together around its payload, with its places as constants.

One is printed for frames without rare things. It refuses what is odd in any way, as the runtime has
a description of the frame for that. A checksum of bytes is summed up where these are stuffed, so
that nothing is looked at twice.
"""

from __future__ import annotations

from collections.abc import Iterable

from protogen.model.frame_places import Place, Run, Side
from protogen.model.frame_plan import FramePlan
from protogen.model.part_plans import ChecksumPlan, StuffedRegion
from protogen.model.parts import (
    ChecksumPart,
    ChoicePart,
    IdentityPart,
    LengthPart,
    LiteralPart,
    NumberPart,
    Part,
    TypedPart,
)
from protogen.targets.braces import BracedLines
from protogen.targets.naming import Thing
from protogen.targets.typescript.at_once import is_taken_at_once
from protogen.targets.typescript.literals import Code, literal
from protogen.targets.typescript.names import locals_table


def is_put_together(plan: FramePlan) -> bool:
    """True if a function is printed for such frames: those that are taken at once are plain."""
    numbers = [item.part for item in plan.placed if isinstance(item.part, TypedPart)]
    is_odd = any(part.size > 4 or isinstance(part, ChoicePart) for part in numbers)
    counts_wire = plan.length is not None and plan.length.over_wire
    needs_more = len(plan.checksums) > 1 or plan.frame.limit is not None
    return is_taken_at_once(plan) and not (is_odd or counts_wire or needs_more)


class PutTogether:
    """Prints the function for a frame."""

    def __init__(self, plan: FramePlan) -> None:
        self._plan = plan
        self._lines = BracedLines(2, 2)
        self._names = locals_table()
        self._tests: list[str] = []
        """What is true of a frame that is odd."""

    def text(self) -> Code:
        """The function, of the runtime's `FrameMaker` and `Writer`, and of what callers give."""
        plan, add = self._plan, self._lines.add
        known = [f"name !== {literal(part.name)}" for part in plan.frame.caller_parts]
        others = f"const name in given) if ({' && '.join(known)})" if known else "const _ in given)"
        add(f"for ({others} return null;")
        numbers = [(it, it.part) for it in plan.placed if not isinstance(it.part, ChecksumPart)]
        stored = [(item.place, self._bytes_of(part)) for item, part in numbers]
        if self._tests:
            add(f"if ({' || '.join(self._tests)}) return null;")
        add("const end = w.size;", f"w.room({plan.tail_size + len(plan.end_bytes)});")
        add("const { bytes } = w;")
        for place, values in stored:
            self._store(place, values)
        self._store(Place(Side.TAIL, plan.tail_size), plan.end_bytes)
        if self._summed is None:
            for found in plan.checksums:
                add(f"const sum = f.sum(bytes, {_at(_run(found).first)}, {_at(_run(found).end)});")
                self._store(found.placed.place, _bytes(found.part, "sum"))
        if plan.region is None:
            add("return w.taken();")
        else:
            self._stuff(plan.region)
        return Code("\n".join(["(f, w, given, counts) => {", *self._lines.lines, "  }"]))

    def _bytes_of(self, part: Part) -> Iterable[object]:
        """The bytes of a part; print its variable, which is negative where something is odd."""
        if isinstance(part, LiteralPart):
            return part.bytes
        assert isinstance(part, NumberPart)
        frame = self._plan.frame
        name = self._names.add(part.name, Thing("variable", ("local", part.name)))
        if isinstance(part, IdentityPart):
            value = f"f.identity({frame.identity.index(part)})"
        elif isinstance(part, LengthPart):
            value = "f.length(w.size)"
        else:
            usual = f"f.usual({frame.caller_parts.index(part)}, counts)"
            own = f"given[{literal(part.name)}] ?? {usual}"
            value = f"f.number({own}, {part.least}, {part.greatest})"
        self._lines.add(f"const {name} = {value};")
        if not isinstance(part, IdentityPart):
            self._tests.append(f"{name} < 0")
        return _bytes(part, name)

    def _store(self, place: Place, values: Iterable[object]) -> None:
        """Print what stores bytes."""
        for offset, value in enumerate(values, place.offset):
            self._lines.add(f"bytes[{_at(Place(place.side, offset))}] = {value};")

    @property
    def _summed(self) -> ChecksumPlan | None:
        """The checksum that is summed up byte by byte, where these are stuffed."""
        region, sums = self._plan.region, self._plan.checksums
        if region is None or not sums:
            return None
        run, spec = _run(sums[0]), sums[0].part.algorithm
        is_in = not run.first.is_tail and run.first.offset >= region.before
        is_behind = run.end == sums[0].placed.place == Place(Side.TAIL, 0)
        is_plain = spec.is_folded_byte and spec.is_bare
        return sums[0] if is_in and is_behind and is_plain else None

    def _stuff(self, region: StuffedRegion) -> None:
        """Print what copies all bytes, those of a region as they are stuffed."""
        plan, add = self._plan, self._lines.add
        add(f"const wire = w.wire({region.longest} * w.size);", "let at = 0;", "let i = 0;")
        copied, stuffed = Place(Side.HEAD, 0), Place(Side.HEAD, region.before)
        if stuffed != copied:
            add(f"for (; i < {_at(stuffed)}; i++) wire[at++] = bytes[i] ?? 0;")
        if (found := self._summed) is not None:
            spec, first = found.part.algorithm, _run(found).first
            self._loop(region, stuffed, first)
            add(f"let sum = {spec.init};")
            stuffed = Place(Side.TAIL, 0)
            self._loop(region, first, stuffed, f"sum {'^' if spec.kind == 'xor' else '+'}= byte;")
            add(f"bytes[end] = {'-' * spec.negated}sum;")
        self._loop(region, stuffed, Place(Side.TAIL, plan.tail_size))
        if plan.end_bytes:
            add("for (; i < w.size; i++) wire[at++] = bytes[i] ?? 0;")
        add("return wire.slice(0, at);")

    def _loop(self, region: StuffedRegion, first: Place, end: Place, *summing: str) -> None:
        """Print what stuffs the bytes from a place to another, if there are any."""
        if first == end:
            return
        with self._lines.block(f"for (; i < {_at(end)}; i++)"):
            # No byte is missing, but types don't know that.
            self._lines.add("const byte = bytes[i] ?? 0;", *summing)
            word = ""
            for byte, sequence in region.codes:
                put = " ".join(f"wire[at++] = {item};" for item in sequence)
                self._lines.add(f"{word}if (byte === {byte}) {{ {put} }}")
                word = "else "
            self._lines.add(f"{word}wire[at++] = byte;")


def _bytes(part: TypedPart, name: str) -> list[str]:
    """The bytes of the number that a variable has."""
    shifts = [f" >> {shift}" if shift else "" for shift in range(0, 8 * part.size, 8)]
    in_order = shifts if part.type.byte_order == "little" else shifts[::-1]
    return [f"{name}{shift}" for shift in in_order]


def _run(plan: ChecksumPlan) -> Run:
    """What such a checksum runs over."""
    (run,) = plan.covers
    assert isinstance(run, Run)
    return run


def _at(place: Place) -> str:
    """A place in the content, of which the payload reaches up to `end`."""
    if not place.is_tail:
        return str(place.offset)
    return f"end + {place.offset}" if place.offset else "end"
