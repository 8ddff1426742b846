"""Numbers of a frame whose bits are parts."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from hypothesis import strategies as st

from schema_fuzzing import forms

Data = dict[str, Any]
_FEW = 7
"""Bits of which each value is looked at."""


@dataclass(frozen=True, slots=True)
class Run:
    """Bits of a part, and what they can be together."""

    low: int
    bits: int
    least: int
    greatest: int
    is_constant: bool = False
    of: Run | None = None
    """The bits whose value these have, too."""
    flips: int = 0
    """What that is XORed with."""

    @property
    def written(self) -> str | int:
        """As a schema has it."""
        return self.low if self.bits == 1 else f"{self.low}..{self.low + self.bits - 1}"

    def within(self, low: int, bits: int, copies: Sequence[Run]) -> frozenset[int]:
        """What they can be in a byte that has these bits of the number, and their `copies`."""
        every = (1 << bits) - 1
        if self.bits <= bits:
            placed = ((self.low, 0), *((copy.low, copy.flips) for copy in copies))
            return frozenset(
                sum((value ^ flips) << place >> low & every for place, flips in placed)
                for value in range(self.least, self.greatest + 1)
            )
        mask = ((1 << self.bits) - 1) << self.low >> low & every
        return frozenset(
            self.least << self.low >> low & every if self.is_constant else value & mask
            for value in range(every + 1)
        )


def bytes_of(runs: Sequence[Run], size: int, byte_bits: int) -> list[frozenset[int]]:
    """What each byte of a number can be, the one of the lowest bits first."""
    found = []
    for place in range(size):
        values = frozenset({0})
        for run in runs:
            if run.of is not None:
                continue
            copies = [other for other in runs if other.of == run]
            own = run.within(byte_bits * place, byte_bits, copies)
            values = frozenset(one | other for one in values for other in own)
        found.append(values)
    return found


def fill(
    draw: st.DrawFn,
    bits: int,
    new_name: Callable[[], str],
    given: tuple[str, Data, Run] | None,
    *,
    is_sum: bool = False,
) -> tuple[Data, list[Run]]:
    """The named bits of a number of so many, those that are `given` among them.

    Nothing follows from them if they are a sum.
    """
    written: Data = {}
    runs: list[Run] = []
    low = 0
    while low < bits:
        if given is not None and low == given[2].low:
            name, keys, run = given
        else:
            end = given[2].low if given is not None and low < given[2].low else bits
            size = draw(st.integers(1, end - low))
            is_needed = given is None and not runs
            if not is_needed and draw(forms.one_in(4)):
                low += size  # These are 0 in each frame.
                continue
            kinds = ["value"] if is_needed else ["value", "const", "counter"]
            sums = {given[0]} if given is not None and is_sum else set()
            mirrored = draw(_mirrors(written, runs, low, end, sums)) if runs else None
            if mirrored is not None:
                keys, run = mirrored
            else:
                keys, run = _member(draw, low, size, draw(st.sampled_from(kinds)))
            name = new_name()
        is_short = not keys and draw(st.booleans())
        written[name] = run.written if is_short else {"bits": run.written, **keys}
        runs.append(run)
        low += run.bits
    return {name: written[name] for name in draw(st.permutations(list(written)))}, runs


@st.composite
def _mirrors(
    draw: st.DrawFn, written: Data, runs: Sequence[Run], low: int, end: int, sums: set[str]
) -> tuple[Data, Run] | None:
    """Bits from `low` on that follow from some that are there, if they have room; sometimes."""
    sources = [
        (name, run)
        for name, run in zip(written, runs, strict=True)
        if run.of is None
        and not run.is_constant
        and name not in sums
        and run.bits <= min(end - low, _FEW)
    ]
    if not sources or not draw(forms.one_in(3)):
        return None
    name, run = draw(st.sampled_from(sources))
    key, flips = draw(st.sampled_from([("repeats", 0), ("complements", (1 << run.bits) - 1)]))
    copy = Run(low, run.bits, run.least, run.greatest, of=run, flips=flips)
    return {key: name, **draw(forms.about())}, copy


def _member(draw: st.DrawFn, low: int, bits: int, kind: str) -> tuple[Data, Run]:
    least, greatest = 0, (1 << bits) - 1
    keys: Data = {}
    if kind == "const":
        keys["const"] = draw(st.integers(0, greatest))
        return keys, Run(low, bits, keys["const"], keys["const"], is_constant=True)
    if kind == "counter":
        keys["counter"] = True
    if draw(forms.one_in(3)):
        least = draw(st.integers(0, greatest))
        greatest = draw(st.integers(least, greatest))
        keys["range"] = [draw(forms.raw_number(end)) for end in (least, greatest)]
    if draw(st.booleans()):
        keys["default"] = draw(forms.raw_number(draw(st.integers(least, greatest))))
    return {**keys, **draw(forms.about())}, Run(low, bits, least, greatest)
