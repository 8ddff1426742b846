"""Checksums of a frame: their algorithms, and the parts that they cover."""

from __future__ import annotations

from collections.abc import Sequence

from protogen.model.checksums import ChecksumSpec, algorithm_names, find_algorithm
from protogen.model.frame import ChecksumPart, Cobs, Frame, PartType
from protogen.passes.context import Context, Loc, about
from protogen.passes.framing.part_runs import written_out
from protogen.problems import hint_for
from protogen.schema.syntax.parts import CrcParameters
from protogen.schema.syntax.parts import Part as PartSyntax

PAYLOAD = "payload"


class ChecksumReader:
    """Resolves the checksums of the frame at `loc`."""

    def __init__(self, context: Context, loc: Loc, names: Sequence[str]) -> None:
        self._context = context
        self._loc = loc
        self._names = names

    def read(self, name: str, item: PartSyntax, type_: PartType) -> ChecksumPart | None:
        """One checksum, or None where it is not clear."""
        algorithm = self._algorithm(name, item)
        covers = self._covers(name, item)
        if algorithm is None or covers is None:
            return None
        if algorithm.width != type_.bits:
            text = f"{algorithm.name} has {algorithm.width} bits, {item.type} has {type_.bits}"
            self._error("PG135", name, "type", text)
        if item.when is not None and self._is_in_front(name):
            text = "in front of the payload, a receiver can't know yet whether it is empty"
            self._error("PG131", name, "when", text, "put the checksum behind the payload")
        return ChecksumPart(
            name=name,
            type=type_,
            algorithm=algorithm,
            covers=covers,
            over_wire=item.over == "wire",
            when_payload=item.when is not None,
            about=about(item.doc, item.source, self._context.find_key((*self._loc, name))),
        )

    def _error(self, code: str, name: str, key: str, text: str, hint: str | None = None) -> None:
        self._context.error(code, (*self._loc, name, key), text, hint)

    def _is_in_front(self, name: str) -> bool:
        names = self._names
        return PAYLOAD in names and names.index(name) < names.index(PAYLOAD)

    def _algorithm(self, name: str, item: PartSyntax) -> ChecksumSpec | None:
        if isinstance(item.algorithm, CrcParameters):
            return self._parameters(name, item.algorithm)
        found = find_algorithm(item.algorithm or "")
        if found is None:
            hint = hint_for(item.algorithm or "", algorithm_names())
            text = f"there is no checksum algorithm `{item.algorithm}`"
            self._error("PG134", name, "algorithm", text, hint)
        return found

    def _parameters(self, name: str, given: CrcParameters) -> ChecksumSpec | None:
        for key in ("poly", "init", "xorout"):
            if getattr(given, key) >> given.width:
                loc = (*self._loc, name, "algorithm", key)
                text = f"`{key}` has more than {given.width} bits"
                self._context.error("PG135", loc, text)
                return None
        return ChecksumSpec(name="CRC", kind="crc", **given.model_dump())

    def _covers(self, name: str, item: PartSyntax) -> tuple[str, ...] | None:
        if item.covers is None:
            text = f"`{name}` does not say what it covers"
            loc = (*self._loc, name)
            self._context.error_at_key("PG131", loc, text, "add `covers: FIRST..LAST`")
            return None
        covers = written_out(self._context, self._names, item.covers, (*self._loc, name, "covers"))
        if name in covers:
            self._error("PG136", name, "covers", f"the checksum `{name}` covers itself")
        return covers


def check_checksums(context: Context, frame: Frame, loc: Loc) -> None:
    """Check what can only be asked when all parts are there."""
    in_circles: set[str] = set()
    for part in frame.checksums:
        circle = [] if part.name in in_circles else _circle(frame, part.name)
        in_circles.update(circle)
        if circle:
            text = f"the checksums cover each other: {' -> '.join((*circle, part.name))}"
            context.error("PG136", (*loc, part.name, "covers"), text)
        if part.over_wire and _holds_cobs(frame, part):
            text = "bytes that COBS makes belong to no single part, so none can be summed up"
            context.error("PG131", (*loc, part.name, "over"), text)


def _circle(frame: Frame, name: str) -> list[str]:
    """The checksums that lead from this one back to it by what they cover, or none."""
    covers = {part.name: part.covers for part in frame.checksums}
    paths = [[name]]
    seen = {name}
    for path in paths:
        for covered in covers[path[-1]]:
            if covered == name:
                return path
            if covered in covers and covered not in seen:
                seen.add(covered)
                paths.append([*path, covered])
    return []


def _holds_cobs(frame: Frame, part: ChecksumPart) -> bool:
    return isinstance(frame.encoding, Cobs) and not frame.stuffed.isdisjoint(part.covers)
