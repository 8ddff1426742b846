"""Fields that only count: what they are follows from the fields that they count.

Whoever makes a message may leave them out.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import msgspec

from protogen.model.expression_bounds import Linear, linear
from protogen.model.expressions import Expression, names_in, operands
from protogen.model.nesting import inner_types
from protogen.model.types import Counted, Field, Struct, Switch, Type


class Computed(msgspec.Struct, frozen=True):
    """The field whose number of elements or bytes tells the number of another one."""

    field: str
    line: Linear
    """Its number of elements or bytes, as a line over the other one."""
    is_region: bool
    """True if the bytes are those that its value takes, whatever it holds."""


def computed(fields: Sequence[Field]) -> dict[str, Computed]:
    """For each field of a record that only counts, what it is worked out of."""
    found: dict[str, Computed] = {}
    # What is always there says more than what may be absent, and elements are sooner counted.
    for index, field in sorted(enumerate(fields), key=lambda item: _preference(item[1])):
        by = _count(field)
        line = None if by is None else linear(by)
        if line is None or line.name in found or not _is_left_out(fields[:index], line.name):
            continue
        if any(line.name in names_in(chosen) for chosen in _choosing(fields, line.name)):
            continue
        if field.region is None or _is_built_alone(fields, index, line.name):
            is_region = field.region is not None
            found[line.name] = Computed(field=field.name, line=line, is_region=is_region)
    return found


def counting(fields: Sequence[Field]) -> dict[str, Computed]:
    """Those of `computed` that count, and for which no region has to be built first."""
    return {name: item for name, item in computed(fields).items() if not item.is_region}


def _preference(field: Field) -> tuple[bool, bool]:
    return field.region is not None, field.may_be_absent


def _is_built_alone(fields: Sequence[Field], index: int, name: str) -> bool:
    """True if a region's bytes follow from fields in front, and nothing counts by its size."""
    needs = {path.partition(".")[0] for path in fields[index].type.needs}
    is_known = needs <= {field.name for field in fields[:index]}
    return is_known and not any(name in field.type.needs for field in fields)


def _is_left_out(fields: Sequence[Field], name: str) -> bool:
    """True if a field of this name is one of these, and nothing stands for it yet."""
    field = next((item for item in fields if item.name == name), None)
    return field is not None and field.const is None and field.default is None


def _count(field: Field) -> Expression | None:
    extent = field.region or field.type.extent
    if field.const is not None or not isinstance(extent, Counted):
        return None
    return extent.by if all(operand.run is None for operand in operands(extent.by)) else None


def _choosing(fields: Sequence[Field], name: str) -> Iterator[Expression]:
    """The expressions that choose a case, or whether a field is there, of all of these fields.

    Inside of them, those in which the name means the same field.
    """
    for field in fields:
        if field.when is not None:
            yield field.when
        yield from _choosing_in(field.type, name)


def _choosing_in(type_: Type, name: str) -> Iterator[Expression]:
    if isinstance(type_, Switch):
        yield type_.selector
    if isinstance(type_, Struct):
        names = [field.name for field in type_.fields]
        # Behind a field of the same name, the name means that one.
        end = names.index(name) + 1 if name in names else len(names)
        yield from _choosing(type_.fields[:end], name)
        return
    for inner in inner_types(type_):
        yield from _choosing_in(inner, name)
