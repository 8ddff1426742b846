"""Functions that stuff a region and sum it up on the way, so that no byte is looked at twice.

One is printed where the checksum is that of bytes and the last one of the region. All else of a
frame is put together by the runtime.
"""

from __future__ import annotations

from protogen.model.frame_plan import FramePlan
from protogen.model.plain_frames import folded_run
from protogen.targets.braces import BracedLines
from protogen.targets.typescript.literals import Code


def stuffing(plan: FramePlan) -> Code | None:
    """The function, of the runtime's `Stuff`; None where there is nothing to sum up."""
    region, run = plan.region, folded_run(plan)
    if region is None or run is None:
        return None
    spec, lines = plan.checksums[0].part.algorithm, BracedLines(2, 2)
    lines.add("const { bytes } = w;", f"const wire = w.wire({region.longest} * w.size);")
    lines.add(f"let at = {region.before};", f"let i = {region.before};", "let sum = 0;")
    with lines.block("for (let turn = 0; turn < 3; turn++)"):
        lines.add(f"const stop = turn ? end + turn - 1 : {run.first.offset};")
        lines.add(f"if (turn === 1) sum = {spec.init};")
        lines.add(f"else if (turn === 2) bytes[end] = {'-' * spec.negated}sum;")
        with lines.block("for (; i < stop; i++)"):
            # No byte is missing, but types don't know that.
            lines.add("const byte = bytes[i] ?? 0;")
            lines.add(f"sum {'^' if spec.kind == 'xor' else '+'}= byte;")
            word = ""
            for byte, sequence in region.codes:
                put = " ".join(f"wire[at++] = {item};" for item in sequence)
                lines.add(f"{word}if (byte === {byte}) {{ {put} }}")
                word = "else "
            lines.add(f"{word}wire[at++] = byte;")
    lines.add("return at;")
    return Code("\n".join(["(w, end) => {", *lines.lines, "  }"]))
