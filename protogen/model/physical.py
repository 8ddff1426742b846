"""Physical values as lines over raw ones, in whole numbers."""

from __future__ import annotations

from math import lcm
from typing import NamedTuple

from protogen.model.types import Field


class PhysicalLine(NamedTuple):
    """The physical value is (raw x `factor` + `term`) / `divisor`."""

    factor: int
    term: int
    divisor: int


def line_of(field: Field) -> PhysicalLine:
    """The line of a field's scale and offset; the divisor is above 0."""
    divisor = lcm(field.scale.denominator, field.offset.denominator)
    return PhysicalLine(int(field.scale * divisor), int(field.offset * divisor), divisor)
