"""Columns of what is in no row, because it is constant or holds nothing.

Lists of such structs still have as many elements as a number says.
"""

from __future__ import annotations

from collections import ChainMap
from collections.abc import Callable, Iterable, Sequence

import msgspec
import numpy as np

from protogen.convert.columns.arrays import Array
from protogen.convert.columns.composite_arrays import Cases, ListsOf, Same, Scattered, Structs
from protogen.convert.columns.event_values import constant_of
from protogen.convert.columns.python_values import Values
from protogen.model.types import Array as ArrayType
from protogen.model.types import Counted, Field, Fixed, Struct, Switch, Type

Scope = ChainMap[str, Array]
"""The numbers in front, which count and choose, of each row."""

# --- numbers in front -----------------------------------------------------------------------------


def constants_in(fields: Iterable[Field], count: int) -> dict[str, Array]:
    """The constant integers, which may count and choose, too."""
    numbers = {it.name: it.const for it in fields if isinstance(it.const, int)}
    return {name: np.broadcast_to(number, count) for name, number in numbers.items()}


def at_places(scope: Scope, places: Callable[[], Array]) -> Scope:
    """Numbers that count and choose in these rows."""
    return ChainMap(_Picked(scope, places))


class CaseRows(msgspec.Struct, frozen=True):
    """The rows that have one case of a switch."""

    rows: Array
    """Their numbers."""
    places: Array
    """The place among them of each row; -1: it has another case."""
    scope: Scope
    """Numbers that count and choose in them."""

    @classmethod
    def where(cls, there: Array, scope: Scope) -> CaseRows:
        """Rows where `there` holds."""
        rows = np.flatnonzero(there)
        places = np.full(len(there), -1, "i8")
        places[rows] = np.arange(len(rows))
        return cls(rows, places, at_places(scope, lambda: rows))

    def __len__(self) -> int:
        return len(self.rows)


class _Picked(dict[str, Array]):
    """Picks rows of what is asked for, and of nothing else."""

    def __init__(self, scope: Scope, places: Callable[[], Array]) -> None:
        super().__init__()
        self._scope = scope
        self._places = places

    def __missing__(self, name: str) -> Array:
        found: Array = self._scope[name][self._places()]
        self[name] = found
        return found


# --- values ---------------------------------------------------------------------------------------


def constant_values(item: Field, type: Type, count: int, scope: Scope) -> Values:
    """The values of what is constant or holds nothing, so many times."""
    if item.const is not None:
        return Same(constant_of(item, type), count)
    match type:
        case Struct(fields=fields):
            inner = scope.new_child()
            members = {}
            for member in fields:
                members[member.name] = constant_values(member, member.type, count, inner)
                inner.update(constants_in([member], count))
            return Structs(members, count)
        case ArrayType(element=Struct() | Switch() | ArrayType()):
            return _constant_lists(item, type, count, scope)
        case Switch():
            return _constant_cases(item, type, count, scope)
        case _:
            return Same([], count)  # Nothing else holds nothing but an empty list.


def _constant_lists(item: Field, type: ArrayType, count: int, scope: Scope) -> ListsOf:
    extent = type.extent
    counts = (
        scope[extent.field].astype("i4")
        if isinstance(extent, Counted)
        else np.full(count, extent.count if isinstance(extent, Fixed) else 0, "i4")
    )
    inner = at_places(scope, lambda: np.repeat(np.arange(count), counts))
    return ListsOf(constant_values(item, type.element, int(counts.sum()), inner), counts)


def _constant_cases(item: Field, type: Switch, count: int, scope: Scope) -> Cases:
    chosen = scope[type.selector]
    members = {}
    for case in type.cases:
        having = CaseRows.where(chosen == case.value, scope)
        if len(having):
            values = constant_values(item, case.type, len(having), having.scope)
            members[case.name] = Scattered(values, having.places)
    return Cases(members, count)


def followed(values: Values, path: Sequence[str]) -> Values:
    """Values that the rest of a path leads to."""
    if not path:
        return values
    if isinstance(values, Structs):
        return followed(values.members[path[0]], path[1:])
    assert isinstance(values, Cases)
    found = values.members.get(path[0])
    if found is None:
        return Same(None, len(values))
    return Scattered(followed(found.values, path[1:]), found.places)
