"""Identities as they are written: values of the frame's identity parts."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import combinations

from protogen.model.frame import Frame
from protogen.model.identities import Identities, Runs
from protogen.model.parts import IdentityPart
from protogen.passes.context import Context, Loc
from protogen.passes.framing.part_values import number_of
from protogen.problems import hint_for
from protogen.schema.syntax.messages import IdentityRange, IdentityValues

_ONLY = ""
"""Stands for the frame's only identity part, where `id` is not a mapping of parts."""


class IdentityReader:
    """Reads the `id` of what stands at `loc`, which problems call `name`."""

    def __init__(self, context: Context, loc: Loc, name: str) -> None:
        self._context = context
        self._loc: Loc = (*loc, "id")
        self._owner = loc
        self._name = name

    def read(self, written: Mapping[str, IdentityValues] | None, frame: Frame) -> Identities | None:
        """The identities in this frame, or None where they are not whole, or out of range."""
        parts = {part.name: part for part in frame.identity}
        given = dict(written or {})
        is_only = set(given) == {_ONLY} and len(parts) == 1
        if is_only:
            given = dict.fromkeys(parts, given[_ONLY])
        if not self._names_parts(set(given), list(parts)):
            return None
        found = [
            self._runs(part, given[name], self._loc if is_only else (*self._loc, name))
            for name, part in parts.items()
        ]
        known = tuple(runs for runs in found if runs)
        return Identities(known) if len(known) == len(found) else None

    def _names_parts(self, given: set[str], parts: list[str]) -> bool:
        if given == {_ONLY}:
            how = ", ".join(f"{name}: ..." for name in parts)
            text = f"the frame has {len(parts)} identity parts"
            hint = f"write id: {{{how}}}"
            if not parts:
                text = "no part of the frame tells messages apart"
                hint = "mark the part that does, as in `kind: {type: uint8, id: true}`"
            self._context.error("PG151", self._loc, text, hint)
            return False
        for name in sorted(given - set(parts)):
            text = f"`{name}` is no identity part of the frame"
            place = (*self._loc, name)
            self._context.error_at_key("PG151", place, text, hint_for(name, parts))
        missing = [name for name in parts if name not in given]
        if missing:
            text = f"{self._name} does not say its identity: {', '.join(missing)}"
            self._context.error_at_key("PG151", self._owner, text, "add `id`")
        return given == set(parts)

    # -- values -------------------------------------------------------------------------------

    def _runs(self, part: IdentityPart, values: IdentityValues, loc: Loc) -> Runs:
        """The values of a part; none where they are wrong."""
        places = [(*loc, index) for index in range(len(values))] if len(values) > 1 else [loc]
        found = [self._run(part, value, place) for value, place in zip(values, places, strict=True)]
        runs = tuple(run for run in found if run is not None)
        if len(runs) < len(found) or not self._differ(part, runs, places):
            return ()
        return runs

    def _run(
        self, part: IdentityPart, value: int | str | IdentityRange, place: Loc
    ) -> tuple[int, int] | None:
        if isinstance(value, IdentityRange):
            if part.type.is_text:
                text = f"`{part.name}` is a text, and texts have no range"
                self._context.error("PG192", place, text, "list those that are meant")
                return None
            first, last = value.range
        else:
            number = number_of(self._context, place, part, value)
            if number is None:
                return None
            first = last = number
        if first > last:
            text = f"the range is empty: {first} is greater than {last}"
            self._context.error("PG115", place, text)
            return None
        wrong = [end for end in (first, last) if not part.holds(end)]
        if wrong:
            text = f"{part.shown(wrong[0])} is no value of `{part.name}`: {part.allowed}"
            self._context.error("PG152", place, text)
            return None
        return first, last

    def _differ(self, part: IdentityPart, runs: Runs, places: Sequence[Loc]) -> bool:
        for (one, _), (other, place) in combinations(zip(runs, places, strict=True), 2):
            both = max(one[0], other[0])
            if both <= min(one[1], other[1]):
                text = f"{part.shown(both)} stands among these values twice"
                self._context.error("PG191", place, text, "write it once")
                return False
        return True
