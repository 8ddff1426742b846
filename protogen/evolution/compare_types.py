"""Changes in a field's type."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING

from protogen.copying import replace
from protogen.evolution.change import Change, Mark, named
from protogen.evolution.shapes import are_crossed
from protogen.model.expressions import Expression, Operand, plain_name, rebuilt
from protogen.model.meanings import BitField, Enum, Flags, NamedBit
from protogen.model.numbers import are_read_alike, are_spelled_alike
from protogen.model.types import (
    Array,
    Between,
    BitOrder,
    Counted,
    Delimited,
    Extent,
    Fill,
    Fixed,
    Float,
    Integer,
    Marked,
    Octets,
    Struct,
    Switch,
    Text,
    TextForm,
    Type,
    Until,
)

if TYPE_CHECKING:
    from protogen.model.types import Field

Report = Callable[[str, str, str], Change]
"""Makes a change of a rule, a place inside the field, and words."""
CompareFields = Callable[["Sequence[Field]", "Sequence[Field]", str], Iterator[Change]]


class TypeComparison:
    """Compares the types of one field."""

    def __init__(self, report: Report, fields: CompareFields, renamed: Mapping[str, str]) -> None:
        self._report = report
        self._fields = fields
        self._renamed = renamed
        """New names of the fields beside this one, which count and select."""

    def compare(self, old: Type, new: Type, path: str) -> Iterator[Change]:
        """Yield what changed between two types."""
        match old, new:
            case Integer(), Integer():
                yield from self._integers(old, new, path)
            case Float(), Float():
                yield from self._floats(old, new, path)
            case Text(), Text():
                yield from self._strings(old, new, path)
            case Octets(), Octets():
                yield from self._strings(old, new, path)
            case _ if type(old) is not type(new) and _bytes(old) == _bytes(new) is not None:
                yield self._report("field-kind", path, named(old.label, new.label))
            case Array(), Array():
                extent = _without_tail(_with_new_names(old, new))
                yield from self._extents(extent, _without_tail(new.extent), path)
                yield from self._packing(old, new, path)
                yield from self.compare(old.element, new.element, path)
            case Struct(), Struct():
                yield from self._packing(old, new, path)
                yield from self._fields(old.fields, new.fields, path)
            case Switch(), Switch():
                yield from self._switches(old, new, path)
            case _:
                yield self._report("field-encoding", path, named(old.label, new.label))

    def _integers(self, old: Integer, new: Integer, path: str) -> Iterator[Change]:
        words = named(old.label, new.label)
        # A packed bool is a bit like any other; elsewhere it is a byte that is 0 or 1.
        is_bool = [kind.role == "bool" and not kind.packed for kind in (old, new)]
        is_wider = old.size != new.size or not any(is_bool)
        is_alike = (old.packed, old.text) == (new.packed, new.text)
        tests = {
            "field-width": old.bits != new.bits and is_wider,
            "field-sign": old.signed != new.signed,
            "field-byte-order": old.byte_order != new.byte_order and is_alike,
            "field-encoding": old.byte_bits != new.byte_bits
            or is_bool[0] != is_bool[1]
            or not are_read_alike(old.text, new.text),
            "field-spelling": are_read_alike(old.text, new.text)
            and not are_spelled_alike(old.text, new.text),
        }
        found = [rule for rule, differs in tests.items() if differs]
        if old.size != new.size or old.size == 1:
            found = [rule for rule in found if rule != "field-byte-order"] or found
        yield from (self._report(rule, path, words) for rule in found)
        if not found and old.role != new.role:
            yield self._report("field-kind", path, words)
        yield from self._enums(self._report, old.enum, new.enum, path)
        yield from self._flags(old.flags, new.flags, path)
        yield from self._bits(old.bit_fields, new.bit_fields, path)

    def _floats(self, old: Float, new: Float, path: str) -> Iterator[Change]:
        words = named(old.label, new.label)
        if old.bits != new.bits:
            yield self._report("field-width", path, words)
        elif old.byte_order != new.byte_order:
            yield self._report("field-byte-order", path, words)
        if old.byte_bits != new.byte_bits:
            yield self._report("field-encoding", path, words)

    def _strings(self, old: Text | Octets, new: Text | Octets, path: str) -> Iterator[Change]:
        yield from self._extents(old.extent, new.extent, path)
        if old.byte_bits != new.byte_bits or _form_of(old) != _form_of(new):
            yield self._report("field-encoding", path, named(old.label, new.label))

    def _extents(self, old: Extent, new: Extent, path: str) -> Iterator[Change]:
        if isinstance(old, Counted):
            old = replace(old, by=self.now(old.by))
        if old == new:
            return
        ends = [_end(extent) for extent in (old, new)]
        rule = "field-count" if ends[0] == ends[1] else "field-encoding"
        yield self._report(rule, path, named(_amount(old), _amount(new)))

    def compare_regions(
        self, old: Fixed | Counted | None, new: Fixed | Counted | None, path: str
    ) -> Iterator[Change]:
        """The changes of what tells how many bytes a field takes."""
        if old is not None and new is not None:
            yield from self._extents(old, new, path)
        elif old is not new:
            yield self._report("field-encoding", path, named(_region(old), _region(new)))

    def _packing(self, old: Array | Struct, new: Array | Struct, path: str) -> Iterator[Change]:
        if old.packed != new.packed:
            words = named(_packed(old.packed), _packed(new.packed))
            yield self._report("field-encoding", path, words)

    def _switches(self, old: Switch, new: Switch, path: str) -> Iterator[Change]:
        if self.now(old.selector) != new.selector:
            chosen = f"the cases of {old.selector.text}", f"those of {new.selector.text}"
            words = named(*chosen)
            yield self._report("field-cases", path, words)
        before = {case.value: case for case in old.cases if case.value is not None}
        after = {case.value: case for case in new.cases if case.value is not None}
        for value in sorted(before.keys() | after.keys()):
            if (value in before) != (value in after):
                rule = "field-kind" if self._only_moved(value, old, new) else "field-cases"
                found = self._report(rule, path, _moved(value, old, new))
                name = plain_name(new.selector)
                if name is not None:
                    marks = Mark(-1, value), Mark(-1, value)
                    found = replace(found, marks=marks, selector=name)
                yield found
            else:
                case = before[value]
                yield from self.compare(case.type, after[value].type, path)
        yield from self._other_cases(old, new, path)

    def _only_moved(self, value: int, old: Switch, new: Switch) -> bool:
        """True if a value has the same bytes with the same meaning, with and without its case."""
        before, after = old.case(value), new.case(value)
        if before is None or after is None:
            return False
        return not list(self.compare(before.type, after.type, ""))

    def _other_cases(self, old: Switch, new: Switch, path: str) -> Iterator[Change]:
        """The changes of what values have that no case names."""
        if old.otherwise is not None and new.otherwise is not None:
            yield from self.compare(old.otherwise.type, new.otherwise.type, path)
        elif _of_others(old) != _of_others(new):
            gone = "no case `else` any more: " if old.otherwise is not None else ""
            words = f"{gone}values without a case {_of_others(new)}"
            yield self._report("field-cases", path, words)

    def now(self, expression: Expression) -> Expression:
        """The expression with the new names of the fields beside this one."""

        def change(item: Expression) -> Expression:
            if not isinstance(item, Operand):
                return item
            first, *rest = item.path
            return replace(item, path=(self._renamed.get(first, first), *rest))

        return rebuilt(expression, change)

    # --- named values ---------------------------------------------------------------------------

    def _enums(
        self, report: Report, old: Enum | None, new: Enum | None, path: str
    ) -> Iterator[Change]:
        before: dict[str, int] = {} if old is None else {v.name: v.value for v in old.values}
        after: dict[str, int] = {} if new is None else {v.name: v.value for v in new.values}
        was, is_ = old is not None and old.closed, new is not None and new.closed
        for change in named_values(report, before, after, path):
            mark = change.marks[0]
            if change.rule == "enum-value-added" and was:
                yield replace(change, rule="enum-closed-added")
            elif change.rule == "enum-value-deleted" and is_ and mark not in _marks(after):
                yield replace(change, rule="enum-closed-deleted")
            else:
                yield change
        if was != is_:
            words = "unnamed values are " + ("refused" if is_ else "taken")
            yield report("enum-closed" if is_ else "enum-opened", path, words)

    def _flags(self, old: Flags | None, new: Flags | None, path: str) -> Iterator[Change]:
        before: dict[str, NamedBit] = {} if old is None else {bit.name: bit for bit in old.bits}
        after: dict[str, NamedBit] = {} if new is None else {bit.name: bit for bit in new.bits}
        numbers = {bit.bit: bit.name for bit in after.values()}
        taken = {bit.bit for bit in before.values()}
        renamed = [
            (name, numbers[bit.bit])
            for name, bit in before.items()
            if name not in after and bit.bit in numbers and numbers[bit.bit] not in before
        ]
        rename = "flag-moved" if are_crossed(renamed) else "flag-renamed"
        for name, bit in before.items():
            mark = _flag(bit.bit)
            if name in after:
                if after[name].bit != bit.bit:
                    words = f"{name} {named(f'bit {bit.bit}', f'bit {after[name].bit}')}"
                    found = self._report("flag-moved", path, words)
                    marks = mark, _flag(after[name].bit)
                    yield replace(found, names=(name, name), marks=marks)
            elif bit.bit in numbers and numbers[bit.bit] not in before:
                words = f"bit {bit.bit} {named(name, numbers[bit.bit])}"
                found = self._report(rename, path, words)
                yield replace(found, names=(name, numbers[bit.bit]), marks=(mark, mark))
            else:
                found = self._report("flag-deleted", path, f"{name}, bit {bit.bit}")
                is_lost = bit.bit not in numbers
                yield replace(found, names=(name, None), marks=(mark, mark), is_lost=is_lost)
        for name, bit in after.items():
            if name not in before and bit.bit not in taken:
                found = self._report("flag-added", path, f"{name}, bit {bit.bit}")
                yield replace(found, names=(None, name), marks=(_flag(bit.bit), _flag(bit.bit)))

    def _bits(
        self, old: Sequence[BitField], new: Sequence[BitField], path: str
    ) -> Iterator[Change]:
        old, new = (
            sorted(runs, key=lambda run: (run.low, run.high, run.gaps)) for runs in (old, new)
        )
        words = named(_runs(old) or "none", _runs(new) or "none")
        pairs = list(zip(old, new, strict=False))
        renamed = [(one.name, other.name) for one, other in pairs if one.name != other.name]
        names = {run.name for run in old}
        is_moved = [run.mask for run in old] != [run.mask for run in new]
        if is_moved or are_crossed(renamed) or any(after in names for _, after in renamed):
            yield self._report("bits", path, words)
            return
        if renamed:
            yield self._report("bits-renamed", path, words)
        for one, other in pairs:
            for change in self._enums(self._run_report(one), one.enum, other.enum, path):
                yield replace(
                    change, marks=(_inside(change.marks[0], one), _inside(change.marks[1], one))
                )

    def _run_report(self, run: BitField) -> Report:
        """Reports changes of a run of bits as at a place of its own, inside of the field."""

        def report(rule: str, path: str, text: str) -> Change:
            found = self._report(rule, f"{path}.{run.name}", text)
            return replace(found, path=path, run=run.name)

        return report


def _marks(values: Mapping[str, int]) -> set[Mark]:
    return {Mark(-1, value) for value in values.values()}


def named_values(
    report: Report, old: Mapping[str, int], new: Mapping[str, int], path: str
) -> Iterator[Change]:
    """Changes between the names of a number's values."""
    names = {value: name for name, value in new.items()}
    renamed = [
        (name, names[value])
        for name, value in old.items()
        if name not in new and value in names and names[value] not in old
    ]
    rename = "enum-value" if are_crossed(renamed) else "enum-value-renamed"
    for name, value in old.items():
        mark = Mark(-1, value)
        if name in new:
            if new[name] != value:
                words = f"{name} {named(str(value), str(new[name]))}"
                found = report("enum-value", path, words)
                yield replace(found, names=(name, name), marks=(mark, Mark(-1, new[name])))
        elif value in names and names[value] not in old:
            found = report(rename, path, f"{value} {named(name, names[value])}")
            yield replace(found, names=(name, names[value]), marks=(mark, mark))
        else:
            found = report("enum-value-deleted", path, f"{name}, {value}")
            is_lost = value not in names
            yield replace(found, names=(name, None), marks=(mark, mark), is_lost=is_lost)
    taken = set(old.values())
    for name, value in new.items():
        if name not in old and value not in taken:
            found = report("enum-value-added", path, f"{name}, {value}")
            yield replace(found, names=(None, name), marks=(Mark(-1, value), Mark(-1, value)))


def _inside(mark: Mark | None, run: BitField) -> Mark | None:
    """The mark of a value of a run, in the whole number."""
    return None if mark is None else Mark(run.mask, mark.bits << run.low)


def _flag(bit: int) -> Mark:
    return Mark(1 << bit, 1 << bit)


def _form_of(kind: Text | Octets) -> TextForm | None:
    """How the characters of a text lie in its bytes."""
    return kind.form if isinstance(kind, Text) else None


def _runs(fields: Sequence[BitField]) -> str:
    return ", ".join(f"{item.name} {_places(item)}" for item in fields)


def _places(run: BitField) -> str:
    return " and ".join(f"{low}..{high}" for low, high in run.runs)


def _bytes(kind: Type) -> tuple[Extent, int] | None:
    """Number and width of the bytes of a value, if it is nothing but bytes."""
    match kind:
        case Text() if not kind.form.is_plain:
            return None
        case Text() | Octets():
            return kind.extent, kind.byte_bits
        case Array(element=Integer() as element, extent=extent):
            width = element.byte_bits
            plain = Integer(bits=width, byte_bits=width, role=element.role)
            return (extent, width) if element == plain and plain.role != "bool" else None
    return None


def _end(extent: Extent) -> int | str | Operand | None:
    """What ends bytes or elements where neither a number nor the payload does."""
    match extent:
        case Until():
            return extent.byte
        case Marked():
            return extent.mark
        case Between():
            return extent.characters.hex()
    return None


def _with_new_names(old: Array, new: Array) -> Extent:
    """The old extent with the new names of members of an element that were renamed."""
    if not isinstance(old.extent, Marked):
        return old.extent
    names, element = list[str](), new.element
    for name in old.extent.mark.path:
        fields = element.fields if isinstance(element, Struct) else ()
        found = next((it for it in fields if name in (it.name, it.renamed_from)), None)
        names.append(found.name if found is not None else name)
        element = found.type if found is not None else element
    return replace(old.extent, mark=replace(old.extent.mark, path=tuple(names)))


def _without_tail(extent: Extent) -> Extent:
    """The extent without what stands behind: changes of that are those of its own fields."""
    return replace(extent, tail=None) if isinstance(extent, Fill) else extent


def _packed(order: BitOrder | None) -> str:
    return "whole bytes" if order is None else f"packed bits, {order}"


def _region(extent: Fixed | Counted | None) -> str:
    return "no size" if extent is None else f"a size of {_amount(extent)}"


def _amount(extent: Extent) -> str:
    match extent:
        case Fixed():
            return str(extent.count)
        case Counted():
            return f"{extent.least} to {extent.greatest}, as {extent.by.text} says"
        case Fill():
            return f"{_bounds(extent)}, to the end"
        case Between():
            return f"{_bounds(extent)}, {_between(extent)}"
        case Until():
            return f"{_bounds(extent)}, in front of {extent.byte:02X}"
        case Marked():
            return f"{_bounds(extent)}, to the first whose {extent.mark.label} is not 0"


def _between(extent: Between) -> str:
    """Where a text ends, and what can't stand in it."""
    excluded = bytes(it for it in range(0x20, 0x7F) if it not in extent.alphabet)
    ends = "to the end" if extent.takes_rest else f"to the next {extent.separator:02X}"
    return f"{ends}, without {excluded.hex(' ').upper()}" if excluded else ends


def _bounds(extent: Delimited) -> str:
    return f"{extent.least} to {extent.greatest}" if extent.least else f"up to {extent.greatest}"


def _of_others(switch: Switch) -> str:
    """What a switch does with values that no case names."""
    if switch.otherwise is not None:
        return "have `else`"
    return "are refused" if switch.rest is None else "are taken"


def _moved(value: int, old: Switch, new: Switch) -> str:
    """A case that only one of two switches has."""
    if new.case(value) in (None, new.otherwise):
        else_ = "" if new.otherwise is None else ", but `else`"
        return f"no case {value} any more{else_}"
    return f"a case {value}" + ("" if old.otherwise is None else " instead of `else`")
