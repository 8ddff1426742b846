"""Functions that stuff a region and sum it up on the way, so that no byte is looked at twice.

One is printed where the checksum is that of bytes and the last one of the region. All else of a
frame is put together by the runtime.
"""

from __future__ import annotations

from protogen.model.checksums import ChecksumSpec
from protogen.model.frame_plan import FramePlan
from protogen.model.part_plans import StuffedRegion
from protogen.model.plain_frames import folded_run
from protogen.targets.braces import BracedLines
from protogen.targets.typescript.literals import Code


def stuffing(plan: FramePlan) -> Code | None:
    """The function, of the runtime's `Stuff`; None where there is nothing to sum up."""
    region, run = plan.region, folded_run(plan)
    if region is None or run is None:
        return None
    spec, lines, first = plan.checksums[0].part.algorithm, BracedLines(2, 2), run.first.offset
    lines.add("const { bytes } = w;", f"const wire = w.wire({region.longest} * w.size);")
    lines.add(f"let at = {region.before};", f"let i = {region.before};")
    if first > region.before:
        _stuff(lines, region, str(first))
    lines.add(f"let sum = {spec.init};")
    done = f"if (i === end) bytes[end] = {'-' * spec.negated}sum;"
    _stuff(lines, region, "end + 1", done, adding(spec))
    lines.add("return at;")
    return Code("\n".join(["(w, end) => {", *lines.lines, "  }"]))


def adding(spec: ChecksumSpec) -> str:
    """The statement that takes a byte into a sum or an exclusive or."""
    return f"sum {'^' if spec.kind == 'xor' else '+'}= byte;"


def _stuff(lines: BracedLines, region: StuffedRegion, stop: str, *summing: str) -> None:
    """Print the loop that stuffs the bytes up to a place."""
    with lines.block(f"for (; i < {stop}; i++)"):
        # No byte is missing, but types don't know that.
        lines.add(*summing[:1], "const byte = bytes[i] ?? 0;", *summing[1:])
        word = ""
        for byte, sequence in region.codes:
            put = " ".join(f"wire[at++] = {item};" for item in sequence)
            lines.add(f"{word}if (byte === {byte}) {{ {put} }}")
            word = "else "
        lines.add(f"{word}wire[at++] = byte;")
