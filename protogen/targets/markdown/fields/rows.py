"""The rows of a message's table: one for each thing that lies in its payload."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from fractions import Fraction

import msgspec

from protogen.copying import replace
from protogen.model.payload_plan import (
    AnyStep,
    CaseStep,
    ChooseStep,
    IntegerStep,
    RecordStep,
    RepeatStep,
    without_constant,
)
from protogen.model.sizes import SizeSet
from protogen.targets.markdown.fields.types import type_text
from protogen.targets.markdown.fields.values import Anchors, range_text, unit_text
from protogen.targets.markdown.frames.layout import Place, behind, element
from protogen.targets.markdown.text.origin import about_line
from protogen.targets.markdown.text.path import ROOT, Path
from protogen.targets.markdown.text.words import bounds, code, plural, short_number

_UNNAMED = "value"
"""The field of a case that is one type."""
_UNKNOWN = "Unknown: the document does not say what it is."


class Row(msgspec.Struct, frozen=True, kw_only=True):
    """One row; the texts are Markdown."""

    place: Place
    sizes: SizeSet
    type: str
    name: str
    unit: str = ""
    range: str = ""
    meaning: str = ""


def field_rows(steps: Sequence[AnyStep], anchors: Anchors) -> Iterator[Row]:
    """Yield the rows of a message's fields."""
    return _record_rows(steps, Place(), ROOT, anchors)


def _record_rows(
    steps: Sequence[AnyStep], place: Place, path: Path, anchors: Anchors
) -> Iterator[Row]:
    for step in steps:
        inner = path.field(step.name)
        yield _field_row(step, place, inner, anchors)
        yield from _inner_rows(step, place, inner, anchors)
        size = step.sizes.fixed
        place = behind(inner.shown) if size is None else place.plus(size)


def _field_row(step: AnyStep, place: Place, path: Path, anchors: Anchors) -> Row:
    field = step.field
    return Row(
        place=place,
        sizes=step.sizes,
        type=type_text(step),
        name=code(path.shown),
        unit=unit_text(field),
        range=range_text(field, path, anchors),
        meaning=about_line(field.about, _UNKNOWN if field.unknown else ""),
    )


def _inner_rows(step: AnyStep, place: Place, path: Path, anchors: Anchors) -> Iterator[Row]:
    """Yield the rows of what a field is made of."""
    match without_constant(step):
        case RecordStep(steps=steps):
            yield from _record_rows(steps, place, path, anchors)
        case RepeatStep() as repeat:
            yield from _element_rows(repeat, place, path.element(), anchors)
        case ChooseStep() as choice:
            yield from _choice_rows(choice, place, path, anchors)


def _element_rows(step: RepeatStep, place: Place, path: Path, anchors: Anchors) -> Iterator[Row]:
    inner = step.element
    first = element(place, inner.sizes.fixed, path.shown)
    if not isinstance(inner, RecordStep):
        yield Row(place=first, sizes=inner.sizes, type=type_text(inner), name=code(path.shown))
    yield from _inner_rows(inner, first, path, anchors)


def _choice_rows(step: ChooseStep, place: Place, path: Path, anchors: Anchors) -> Iterator[Row]:
    for case in step.cases:
        yield from _case_rows(step, case, place, path, anchors)
    otherwise, rest = "invalid", SizeSet.exactly(0)
    if step.rest is not None:
        most = plural(step.rest.count.greatest, "byte")
        otherwise, rest = f"raw bytes to the end, at most {most}", step.rest.sizes
    yield Row(place=place, sizes=rest, type=otherwise, name=f"{code(path.shown)} otherwise")


def _case_rows(
    choice: ChooseStep, case: CaseStep, place: Place, path: Path, anchors: Anchors
) -> Iterator[Row]:
    whole = _case_row(choice, case, place, path)
    inner = path.case(case.name)
    alone = _only_value(case.step)
    if alone is None:
        yield whole
        yield from _inner_rows(case.step, place, inner, anchors)
        return
    # The schema gave the case a type and no name; the model makes it a struct of one field.
    inner = Path(path.shown, inner.field(alone.name).anchor)
    yield replace(_field_row(alone, place, inner, anchors), name=whole.name)
    yield from _inner_rows(alone, place, inner, anchors)


def _only_value(step: AnyStep) -> AnyStep | None:
    """Return the field of a case that is a single type."""
    if isinstance(step, RecordStep) and [inner.name for inner in step.steps] == [_UNNAMED]:
        return step.steps[0]
    return None


def _case_row(choice: ChooseStep, case: CaseStep, place: Place, path: Path) -> Row:
    step = case.step
    return Row(
        place=place,
        sizes=step.sizes,
        type=type_text(step) if step.sizes.greatest else "nothing",
        name=f"{code(path.shown)} if {code(choice.selector_name)} is {_case_value(case)}",
        range=_case_range(step),
        meaning=about_line(step.type.about) if isinstance(step, RecordStep) else "",
    )


def _case_value(case: CaseStep) -> str:
    value = code(short_number(case.value))
    return value if case.name == f"case_{case.value}" else f"{value} {case.name}"


def _case_range(step: AnyStep) -> str:
    if not isinstance(step, IntegerStep):
        return ""
    return bounds(Fraction(step.type.least), Fraction(step.type.greatest))
