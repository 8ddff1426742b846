"""Functions that put a frame together around its payload, with its places as constants.

One is printed for frames without rare things. It refuses what is odd in any way, as the runtime has
a description of the frame for that. A checksum of bytes is summed up where it is seen whether one
of them has to be stuffed, as in few frames.
"""

from __future__ import annotations

from collections.abc import Iterable

from protogen.model.frame_places import Place, Run, Side
from protogen.model.frame_plan import FramePlan
from protogen.model.part_plans import StuffedRegion
from protogen.model.parts import (
    IdentityPart,
    LengthPart,
    LiteralPart,
    NumberPart,
    Part,
    TypedPart,
)
from protogen.model.plain_frames import folded_run, summed_run
from protogen.targets.braces import BracedLines
from protogen.targets.naming import Thing
from protogen.targets.typescript.at_once import adding, behind
from protogen.targets.typescript.literals import Code, literal
from protogen.targets.typescript.names import locals_table


class PutTogether:
    """Prints the function for a frame."""

    def __init__(self, plan: FramePlan) -> None:
        self._plan = plan
        self._lines = BracedLines(2, 2)
        self._names = locals_table()

    def text(self) -> Code:
        """The function, of the runtime's `PutTogether`."""
        plan, add, run = self._plan, self._lines.add, folded_run(self._plan)
        known = [f"name !== {literal(part.name)}" for part in plan.frame.caller_parts]
        other = f"name in given) if ({' && '.join(known)})" if known else "_ in given)"
        add(f"for (const {other} return null;")
        stored = [(it.place, self._bytes(it.part)) for it in plan.placed if it.part.size]
        if (room := plan.tail_size + len(plan.end_bytes)) or plan.region:
            add(f"const end = w.room({room});")
        add("const { bytes } = w;")
        for place, values in (*stored, (Place(Side.TAIL, plan.tail_size), plan.end_bytes)):
            for offset, value in enumerate(values, place.offset):
                add(f"bytes[{_at(Place(place.side, offset))}] = {value};")
        if run is None and plan.checksums:
            self._sum()
        if plan.region is None:
            add("return w.taken();")
        elif run is None:
            add("return f.stuffed(w, end);")
        else:
            self._stuff(plan.region, run)
        return Code("\n".join(["(f, w, given, counts) => {", *self._lines.lines, "  }"]))

    def _bytes(self, part: Part) -> Iterable[object]:
        """The bytes of a part; print its variable, which is negative where something is odd."""
        if not isinstance(part, NumberPart):
            return part.bytes if isinstance(part, LiteralPart) else ()
        frame, callers = self._plan.frame, self._plan.frame.caller_parts
        name = self._names.add(part.name, Thing("variable", ("local", part.name)))
        if isinstance(part, IdentityPart):
            self._lines.add(f"const {name} = f.identity({frame.identity.index(part)});")
            return _shifted(part, name)
        value = "f.length(w.size)"
        if not isinstance(part, LengthPart):
            own = f"given[{literal(part.name)}] ?? f.usual({callers.index(part)}, counts)"
            value = f"f.number({own}, {part.least}, {part.greatest})"
        self._lines.add(f"const {name} = {value};", f"if ({name} < 0) return null;")
        return _shifted(part, name)

    def _sum(self) -> None:
        """Print what sums up, and stores it."""
        (found,) = self._plan.checksums
        run = summed_run(found)
        self._lines.add(f"const sum = f.sum(bytes, {_at(run.first)}, {_at(run.end)});")
        side, first = found.placed.place.side, found.placed.place.offset
        for offset, value in enumerate(_shifted(found.part, "sum"), first):
            self._lines.add(f"bytes[{_at(Place(side, offset))}] = {value};")

    def _stuff(self, region: StuffedRegion, run: Run) -> None:
        """Print what sums up, and then stuffs a region; few frames have a byte that is stuffed."""
        add, first, spec = self._lines.add, run.first.offset, self._plan.checksums[0].part.algorithm
        see = f"if ({' || '.join(f'byte === {byte}' for byte, _ in region.codes)}) isClean = false;"
        is_clean = "".join(f" && sum !== {byte}" for byte, _ in region.codes)
        add(f"let sum = {spec.init};", "let isClean = true;")
        if first > region.before:
            self._loop(region.before, str(first), see)
        self._loop(first, "end", adding(spec), see)
        add(f"sum = {'-' * spec.negated}sum & 255;", "bytes[end] = sum;")
        add(f"if (isClean{is_clean}) return w.taken();")
        add(f"const wire = w.wire({region.longest} * w.size);", "let at = 0;")
        add(f"for (; at < {region.before}; at++) wire[at] = bytes[at] ?? 0;")
        self._loop(region.before, "end + 1", *_stuffing(region))
        if self._plan.end_bytes:
            add("for (let i = end + 1; i < w.size; i++) wire[at++] = bytes[i] ?? 0;")
        add("return wire.slice(0, at);")

    def _loop(self, first: int, stop: str, *statements: str) -> None:
        """Print what is done with each byte up to a place."""
        with self._lines.block(f"for (let i = {first}; i < {stop}; i++)"):
            # No byte is missing, but types don't know that.
            self._lines.add("const byte = bytes[i] ?? 0;", *statements)


def _stuffing(region: StuffedRegion) -> list[str]:
    """The statements that put a byte on the wire, or what stands for it."""
    puts = {byte: "".join(f" wire[at++] = {it};" for it in word) for byte, word in region.codes}
    tests = [f"if (byte === {byte}) {{{put} }}" for byte, put in puts.items()]
    return "\nelse ".join([*tests, "wire[at++] = byte;"]).splitlines()


def _shifted(part: TypedPart, name: str) -> list[str]:
    """The bytes of the number that a variable has."""
    shifts = [f" >> {shift}" if shift else "" for shift in range(0, 8 * part.size, 8)]
    in_order = shifts if part.type.byte_order == "little" else shifts[::-1]
    return [f"{name}{shift}" for shift in in_order]


def _at(place: Place) -> str:
    """A place in the content, of which the payload reaches up to `end`."""
    return behind("end" if place.is_tail else "", place.offset)
