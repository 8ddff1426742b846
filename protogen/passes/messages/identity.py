"""Values of a frame's identity parts that an `id` means."""

from __future__ import annotations

from collections.abc import Mapping

from protogen.model.frame import Frame
from protogen.passes.context import Context, Loc
from protogen.problems import hint_for

Identity = tuple[int, ...]
"""Raw value of each identity part, in wire order."""

_ONLY = ""
"""Stands for the frame's only identity part, where `id` is one value."""


class IdentityReader:
    """Reads the `id` of what stands at `loc`, which problems call `name`."""

    def __init__(self, context: Context, loc: Loc, name: str) -> None:
        self._context = context
        self._loc = loc
        self._name = name

    def read(self, written: Mapping[str, int] | None, frame: Frame) -> Identity | None:
        """The identity in this frame, or None where it is not whole, or out of range."""
        parts = {part.name: part for part in frame.identity}
        given = dict(written or {})
        if set(given) == {_ONLY} and len(parts) == 1:
            given = dict.fromkeys(parts, given[_ONLY])
        if not self._names_parts(set(given), list(parts)):
            return None
        fits = True
        for name, part in parts.items():
            if not part.least <= given[name] <= part.greatest:
                text = f"{given[name]} is no value of `{name}`: {part.least} to {part.greatest}"
                self._context.error("PG152", (*self._loc, "id"), text)
                fits = False
        return tuple(given[name] for name in parts) if fits else None

    def _names_parts(self, given: set[str], parts: list[str]) -> bool:
        if given == {_ONLY}:
            how = ", ".join(f"{name}: ..." for name in parts)
            text = f"the frame has {len(parts)} identity parts"
            hint = f"write id: {{{how}}}" if parts else "leave out `id`"
            self._context.error("PG151", (*self._loc, "id"), text, hint)
            return False
        for name in sorted(given - set(parts)):
            text = f"`{name}` is no identity part of the frame"
            place = (*self._loc, "id", name)
            self._context.error_at_key("PG151", place, text, hint_for(name, parts))
        missing = [name for name in parts if name not in given]
        if missing:
            text = f"{self._name} does not say its identity: {', '.join(missing)}"
            self._context.error_at_key("PG151", self._loc, text, "add `id`")
        return given == set(parts)
