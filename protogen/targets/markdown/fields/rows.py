"""The table of a message: everything in its frame, in wire order."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from fractions import Fraction

from protogen.model.frame import Frame
from protogen.model.messages import Message
from protogen.model.packing import FilledPacking, Packing
from protogen.model.parts import PayloadPart
from protogen.model.payload_plan import (
    AnyStep,
    CaseStep,
    ChooseStep,
    IntegerStep,
    OptionalStep,
    PartStep,
    RecordStep,
    RegionStep,
    RepeatStep,
)
from protogen.model.payload_walks import packed_numbers, without_constant
from protogen.model.sizes import SizeSet
from protogen.targets.emitted import EmittedNames
from protogen.targets.markdown.fields.paths import ROOT, Path
from protogen.targets.markdown.fields.types import end_of, type_text
from protogen.targets.markdown.fields.values import Anchors, range_text, unit_text
from protogen.targets.markdown.frames.layout import (
    INDICES,
    Place,
    Slot,
    behind,
    element,
    part_title,
    slots,
)
from protogen.targets.markdown.frames.parts import part_type, role, value_in
from protogen.targets.markdown.text.code_names import in_code
from protogen.targets.markdown.text.origin import about_line
from protogen.targets.markdown.text.table import Table, table
from protogen.targets.markdown.text.words import (
    bit_span,
    bounds,
    code,
    plural,
    short_number,
    size_text,
)

_HEADER = ("Frame byte", "Payload byte", "Size", "Type", "Name", "Unit", "Range", "Meaning")
_UNNAMED = "value"
"""The field of a case that is one type."""
_UNKNOWN = "Unknown: the document does not say what it is."

Row = tuple[str, ...]


def message_table(frame: Frame, message: Message, anchors: Anchors, names: EmittedNames) -> Table:
    """Return the table of everything in a message's frame, in wire order."""
    rows: list[Row] = []
    for slot in slots(frame, frame.payload.sent(message.sizes)):
        if isinstance(slot.part, PayloadPart):
            rows += _PayloadRows(slot, anchors, names).of_record(message.plan.steps, Place(), ROOT)
        else:
            rows += _part_rows(slot, frame, message)
    return table(_HEADER, rows)


def _part_rows(slot: Slot, frame: Frame, message: Message) -> Iterator[Row]:
    held = {field.part: f"The field {code(field.name)}." for field in message.held}
    for place, size, part in slot.rows:
        value, meaning = value_in(frame, part, message), held.get(part.name, role(part))
        yield (place, "", size, part_type(part), part_title(part), "", value, meaning)


class _PayloadRows:
    """Rows of what lies in a payload, which has its place in a frame."""

    def __init__(self, payload: Slot, anchors: Anchors, names: EmittedNames) -> None:
        self._payload = payload
        self._anchors = anchors
        self._names = names
        self._region: RegionStep | None = None
        """The innermost region of so many bytes around the rows."""

    def of_record(self, steps: Sequence[AnyStep], place: Place, path: Path) -> Iterator[Row]:
        for step in steps:
            inner = path.field(step.name)
            if isinstance(step, PartStep):
                cells = self._cells(step, inner, code(inner.shown))
                yield (f"part {code(step.part)}", "", "", *cells)
                continue
            yield self._field(step, place, inner, code(inner.shown))
            yield from self._inside(step, place, inner)
            size = step.field.sizes_in_front.fixed
            place = behind(inner.shown) if size is None else place.plus(size)

    def _inside(self, step: AnyStep, place: Place, path: Path) -> Iterator[Row]:
        """Yield the rows of what a field is made of."""
        match without_constant(step):
            case RecordStep(steps=steps, packing=Packing()):
                yield from self._packed_fields(steps, path)
            case RepeatStep(packing=Packing() | FilledPacking()) as run:
                yield self._packed_elements(run, 0, path)
            case RecordStep(steps=steps):
                yield from self.of_record(steps, place, path)
            case RepeatStep(element=inner):
                path = path.element()
                first = element(place, inner.sizes.fixed, path.shown)
                if not isinstance(inner, RecordStep):
                    text = type_text(inner, self._region)
                    yield self._row(first, inner.sizes, text, code(path.shown))
                yield from self._inside(inner, first, path)
            case ChooseStep() as choice:
                yield from self._choice(choice, place, path)
            case OptionalStep(step=inner):
                yield from self._inside(inner, place, path)
            case RegionStep(step=inner) as region:
                around, self._region = self._region, region
                yield from self._inside(inner, place, path)
                self._region = around

    def _packed_fields(self, steps: Sequence[AnyStep], path: Path) -> Iterator[Row]:
        first = 0
        for step in steps:
            inner = path.field(step.name)
            bits = sum(item.step.type.bits for item in packed_numbers([step]))
            place = bit_span(first, bits)
            yield ("", place, plural(bits, "bit"), *self._cells(step, inner, code(inner.shown)))
            bare = without_constant(step)
            if isinstance(bare, RepeatStep):
                yield self._packed_elements(bare, first, inner)
            first += bits

    def _packed_elements(self, step: RepeatStep, first: int, path: Path) -> Row:
        assert isinstance(step.element, IntegerStep)
        bits, name = step.element.type.bits, code(path.element().shown)
        place = f"{bit_span(first, bits)} + {'' if bits == 1 else bits}{INDICES[0]}"
        cells = ("", place, plural(bits, "bit"), type_text(step.element), name)
        return (*cells, *[""] * (len(_HEADER) - len(cells)))

    def _choice(self, step: ChooseStep, place: Place, path: Path) -> Iterator[Row]:
        for case in step.cases:
            name = f"{code(path.shown)} {_condition(step, case)}"
            inner = path.case(case.name)
            alone = _only_value(case.step)
            if alone is None:
                yield self._case(step, case.step, place, name)
                yield from self._inside(case.step, place, inner)
            else:
                # The schema gave the case a type alone; the model makes it a struct of one field.
                inner = Path(path.shown, inner.field(alone.name).anchor)
                sizes = self._filling(step, alone.sizes)
                yield self._row(place, sizes, *self._cells(alone, inner, name))
                yield from self._inside(alone, place, inner)
        if step.otherwise is not None:
            return
        otherwise, rest = "invalid", SizeSet.exactly(0)
        if step.rest is not None:
            most = plural(step.rest.count.greatest, "byte")
            otherwise = f"raw bytes to {end_of(self._region)}, at most {most}"
            rest = self._filling(step, step.rest.sizes)
        yield self._row(place, rest, otherwise, f"{code(path.shown)} otherwise")

    def _filling(self, step: ChooseStep, sizes: SizeSet) -> SizeSet:
        """Return the sizes of a case that fills the region, if the choice alone lies in one."""
        region = self._region
        if region is None or region.step is not step:
            return sizes
        return sizes.within(region.region.least, region.region.greatest) or sizes

    def _case(self, choice: ChooseStep, step: AnyStep, place: Place, name: str) -> Row:
        type_ = type_text(step, self._region) if step.sizes.greatest else "nothing"
        values = meaning = ""
        if isinstance(step, IntegerStep):
            values = bounds(Fraction(step.type.least), Fraction(step.type.greatest))
        if isinstance(step, RecordStep):
            meaning = about_line(step.type.about)
        sizes = self._filling(choice, step.sizes)
        return self._row(place, sizes, type_, name, "", values, meaning)

    def _field(self, step: AnyStep, place: Place, path: Path, name: str) -> Row:
        return self._row(place, step.sizes, *self._cells(step, path, name))

    def _cells(self, step: AnyStep, path: Path, name: str) -> Row:
        """Return the cells from that of the type on."""
        field = step.field
        values = range_text(field, path, self._anchors)
        unknown = _UNKNOWN if field.unknown else ""
        meaning = about_line(field.about, unknown, in_code(self._names.field(field.name)))
        return (type_text(step, self._region), name, unit_text(field), values, meaning)

    def _row(self, place: Place, sizes: SizeSet, *cells: str) -> Row:
        """Return a row with these cells from that of the type on."""
        if self._region is not None:
            sizes = sizes.within(0, self._region.region.greatest) or sizes
        size, payload = sizes.fixed, self._payload
        in_frame = ""
        if payload.start is not None and not place.base:
            in_frame = place.text(size, payload.start, payload.scale)
        missing = len(_HEADER) - 3 - len(cells)
        return (in_frame, place.text(size), size_text(sizes), *cells, *[""] * missing)


def _only_value(step: AnyStep) -> AnyStep | None:
    """Return the field of a case that is a single type."""
    if isinstance(step, RecordStep) and [inner.name for inner in step.steps] == [_UNNAMED]:
        return step.steps[0]
    return None


def _condition(step: ChooseStep, case: CaseStep) -> str:
    """Return on which condition there is a case."""
    if case.value is None:
        return "otherwise"
    value = code(short_number(case.value))
    name = "" if case.name == f"case_{case.value}" else f" {case.name}"
    return f"if {code(step.expression.text)} is {value}{name}"
