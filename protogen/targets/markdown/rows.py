"""The rows of a message's table: one for each thing that lies in its payload."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from fractions import Fraction

from protogen.model.sizes import SizeSet
from protogen.model.types import Array, Case, Field, Integer, Struct, Switch, Type
from protogen.targets.markdown.layout import Place, behind, element
from protogen.targets.markdown.origin import about_line
from protogen.targets.markdown.path import ROOT, Path
from protogen.targets.markdown.types import type_text
from protogen.targets.markdown.values import Anchors, range_text, unit_text
from protogen.targets.markdown.words import bounds, code, plural, short_number

_UNNAMED = "value"
"""The field of a case that is one type."""
_UNKNOWN = "Unknown: the document does not say what it is."


@dataclass(frozen=True, slots=True, kw_only=True)
class Row:
    """One row; the texts are Markdown."""

    place: Place
    sizes: SizeSet
    type: str
    name: str
    unit: str = ""
    range: str = ""
    meaning: str = ""


def field_rows(fields: tuple[Field, ...], anchors: Anchors) -> Iterator[Row]:
    """Yield the rows of a message's fields."""
    return _struct_rows(fields, Place(), ROOT, anchors)


def _struct_rows(
    fields: tuple[Field, ...], place: Place, path: Path, anchors: Anchors
) -> Iterator[Row]:
    for field in fields:
        inner = path.field(field.name)
        yield _field_row(field, place, inner, anchors)
        yield from _inner_rows(field.type, place, inner, anchors)
        place = behind(inner.shown) if field.size is None else place.plus(field.size)


def _field_row(field: Field, place: Place, path: Path, anchors: Anchors) -> Row:
    return Row(
        place=place,
        sizes=field.type.sizes,
        type=type_text(field.type),
        name=code(path.shown),
        unit=unit_text(field),
        range=range_text(field, path, anchors),
        meaning=about_line(field.about, _UNKNOWN if field.unknown else ""),
    )


def _inner_rows(kind: Type, place: Place, path: Path, anchors: Anchors) -> Iterator[Row]:
    """Yield the rows of what a field is made of."""
    match kind:
        case Struct():
            yield from _struct_rows(kind.fields, place, path, anchors)
        case Array():
            yield from _element_rows(kind, place, path.element(), anchors)
        case Switch():
            yield from _switch_rows(kind, place, path, anchors)


def _element_rows(array: Array, place: Place, path: Path, anchors: Anchors) -> Iterator[Row]:
    first = element(place, array.element.sizes.fixed, path.shown)
    if not isinstance(array.element, Struct):
        yield Row(
            place=first,
            sizes=array.element.sizes,
            type=type_text(array.element),
            name=code(path.shown),
        )
    yield from _inner_rows(array.element, first, path, anchors)


def _switch_rows(switch: Switch, place: Place, path: Path, anchors: Anchors) -> Iterator[Row]:
    for case in switch.cases:
        yield from _case_rows(switch, case, place, path, anchors)
    otherwise = "invalid"
    if switch.rest is not None:
        otherwise = f"raw bytes to the end, at most {plural(switch.rest, 'byte')}"
    rest = SizeSet.between(0, switch.rest or 0)
    yield Row(place=place, sizes=rest, type=otherwise, name=f"{code(path.shown)} otherwise")


def _case_rows(
    switch: Switch, case: Case, place: Place, path: Path, anchors: Anchors
) -> Iterator[Row]:
    whole = _case_row(switch, case, place, path)
    inner = path.case(case.name)
    alone = _only_value(case.type)
    if alone is None:
        yield whole
        yield from _inner_rows(case.type, place, inner, anchors)
        return
    # The schema gave the case a type and no name; the model makes it a struct of one field.
    inner = Path(path.shown, inner.field(alone.name).anchor)
    yield replace(_field_row(alone, place, inner, anchors), name=whole.name)
    yield from _inner_rows(alone.type, place, inner, anchors)


def _only_value(kind: Type) -> Field | None:
    """Return the field of a case that is a single type."""
    if isinstance(kind, Struct) and [field.name for field in kind.fields] == [_UNNAMED]:
        return kind.fields[0]
    return None


def _case_row(switch: Switch, case: Case, place: Place, path: Path) -> Row:
    return Row(
        place=place,
        sizes=case.type.sizes,
        type=type_text(case.type) if case.type.sizes.greatest else "nothing",
        name=f"{code(path.shown)} if {code(switch.selector)} is {_case_value(case)}",
        range=_case_range(case.type),
        meaning=about_line(case.type.about) if isinstance(case.type, Struct) else "",
    )


def _case_value(case: Case) -> str:
    value = code(short_number(case.value))
    return value if case.name == f"case_{case.value}" else f"{value} {case.name}"


def _case_range(kind: Type) -> str:
    if not isinstance(kind, Integer):
        return ""
    return bounds(Fraction(kind.least), Fraction(kind.greatest))
