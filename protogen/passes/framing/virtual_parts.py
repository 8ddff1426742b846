"""Parts that go into checksums and are not sent: where they may be named."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from protogen.model.frame import Frame
from protogen.passes.context import Context, Loc
from protogen.passes.framing.bit_names import are_whole, holders_of
from protogen.passes.framing.part_runs import written_out
from protogen.schema.syntax.parts import Part


def sent_names(parts: Mapping[str, Part]) -> list[str]:
    """The names of the parts that have bytes on the wire, in their order."""
    return [name for name, item in parts.items() if item.is_sent]


def sent_run(
    context: Context, parts: Mapping[str, Part], written: Sequence[str], loc: Loc, what: str
) -> tuple[str, ...]:
    """The parts of a run that are sent; one that names another part is reported.

    `what` says what the run is for, in the words of the problem.
    """
    named = [name for item in written for name in item.split("..")]
    unsent = [name for name in named if name in parts and not parts[name].is_sent]
    for name in dict.fromkeys(unsent):
        kind = "virtual" if parts[name].virtual else "told"
        text = f"`{name}` is {kind}: it has no bytes on the wire, and {what}"
        context.error("PG231", loc, text, "name parts that are sent")
    if unsent or not are_whole(context, holders_of(parts), written, loc):
        return ()
    found = written_out(context, list(parts), written, loc)
    return tuple(name for name in found if parts[name].is_sent)


def check_virtual_parts(context: Context, frame: Frame, loc: Loc) -> None:
    """Check that each is covered by a checksum: else it would do nothing."""
    covered = {name for checksum in frame.checksums for name in checksum.covers}
    for part in frame.virtual:
        if part.name not in covered:
            text = f"no checksum covers `{part.name}`, so that it does nothing"
            hint = "add it to what a checksum `covers`, or leave it out"
            context.error_at_key("PG234", (*loc, part.name), text, hint)
