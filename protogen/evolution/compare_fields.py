"""Changes between the fields of two messages or structs."""

from __future__ import annotations

from collections.abc import Hashable, Iterator, Mapping, Sequence
from fractions import Fraction

import msgspec

from protogen.copying import replace
from protogen.evolution.change import Change, named
from protogen.evolution.compare_types import TypeComparison, named_values
from protogen.evolution.quantities import meaning_of
from protogen.evolution.shapes import are_alike, shape
from protogen.model.presence import Conditional, Trailing
from protogen.model.reading.readings import decimal
from protogen.model.types import Field

_CHANGES = {
    "enum-value": "",
    "enum-value-added": ", is new",
    "enum-value-deleted": ", is gone",
    "enum-value-renamed": "",
}
"""Words about a special value that changed."""


class FieldComparison(msgspec.Struct, frozen=True):
    """Compares fields, and what is inside them, of one message."""

    message: str

    def compare(
        self, old: Sequence[Field], new: Sequence[Field], prefix: str = ""
    ) -> Iterator[Change]:
        """Yield what changed; `prefix` is the path of the struct that the fields are in."""
        renamed, unclear = renames(old, new)
        after = {field.name: field for field in new}
        kept = {renamed.get(field.name, field.name) for field in old} & after.keys()
        places = {field.name: _place(new, index, kept) for index, field in enumerate(new)}
        for index, field in enumerate(old):
            path = _joined(prefix, field.name)
            name = renamed.get(field.name, field.name)
            taken = field.name not in renamed and name in renamed.values()
            other = None if taken else after.get(name)
            if other is None:
                rule = "field-of-frame" if field.part else "field-deleted"
                yield self._change(rule, path, _described(field))
                continue
            if field.name in unclear:
                yield self._change("field-reused", path, named(field.name, other.name))
            elif other.name != field.name:
                change = self._change("field-renamed", path, named(field.name, other.name))
                yield replace(change, now=_joined(prefix, other.name))
            place = _place(old, index, kept, renamed)
            if place != places[other.name]:
                yield self._change("field-moved", path, named(place, places[other.name]))
            yield from self._field(field, other, path, renamed)
        known = ({field.name for field in old} - renamed.keys()) | set(renamed.values())
        for field in new:
            if field.name not in known:
                rule = "field-of-frame" if field.part else "field-added"
                yield self._change(rule, _joined(prefix, field.name), _described(field))

    def _change(self, rule: str, path: str, text: str) -> Change:
        place = f"{self.message}.{path}"
        return Change(rule=rule, place=place, text=text, message=self.message, path=path)

    def _field(
        self, old: Field, new: Field, path: str, renamed: Mapping[str, str]
    ) -> Iterator[Change]:
        types = TypeComparison(self._change, self.compare, renamed)
        yield from types.compare(old.type, new.type, path)
        if _is_told_otherwise(old, new, types):
            words = named(_presence(old), _presence(new))
            yield self._change("field-presence", path, words)
        yield from types.compare_regions(old.region, new.region, path)
        if old.const != new.const:
            yield self._change("field-constant", path, named(_shown(old.const), _shown(new.const)))
        if old.default != new.default:
            words = named(_shown(old.default), _shown(new.default))
            yield self._change("field-default", path, words)
        if shape(old.type) == shape(new.type) or old.ranged or new.ranged:
            yield from self._range(old, new, path)
        yield from self._quantity(old, new, path)
        yield from self._special(old, new, path)

    def _quantity(self, old: Field, new: Field, path: str) -> Iterator[Change]:
        if old.unit != new.unit and meaning_of(old) == meaning_of(new):
            words = named(f"{decimal(old.scale)} {old.unit}", f"{decimal(new.scale)} {new.unit}")
            yield self._change("field-rescaled", path, words)
            return
        if old.scale != new.scale:
            words = named(decimal(old.scale), decimal(new.scale))
            yield self._change("field-scale", path, words)
        if old.offset != new.offset:
            words = named(decimal(old.offset), decimal(new.offset))
            yield self._change("field-offset", path, words)
        if old.unit != new.unit:
            yield self._change("field-unit", path, named(old.unit or "none", new.unit or "none"))

    def _special(self, old: Field, new: Field, path: str) -> Iterator[Change]:
        before = {item.name: item.value for item in old.special}
        after = {item.name: item.value for item in new.special}
        for change in named_values(self._change, before, after, path):
            renamed = change.rule == "enum-value-renamed"
            rule = "field-special-renamed" if renamed else "field-special"
            words = f"{change.text}{_CHANGES[change.rule]}"
            # A special value that is gone is a number like any other.
            yield replace(change, rule=rule, text=words, is_lost=False)

    def _range(self, old: Field, new: Field, path: str) -> Iterator[Change]:
        if (old.least, old.greatest) == (new.least, new.greatest):
            return
        words = named(_bounds(old), _bounds(new))
        narrower = _above(new.least, old.least) or _above(old.greatest, new.greatest, up=True)
        rule = "field-range-narrowed" if narrower else "field-range-widened"
        yield self._change(rule, path, words)


def _above(one: Fraction | None, other: Fraction | None, *, up: bool = False) -> bool:
    """True if a bound is tighter than another; `up` compares greatest values, in swapped order."""
    if up:
        return other is not None and (one is None or other < one)
    return one is not None and (other is None or one > other)


def renames(old: Sequence[Field], new: Sequence[Field]) -> tuple[dict[str, str], set[str]]:
    """Fields with their new names: as `renamed_from` says, else those at the same place.

    The second are those of OLD that may have been swapped: several of one type have other names
    that do not tell which is which.
    """
    before = {field.name for field in old}
    after = {field.name for field in new}
    said = {
        field.renamed_from: field.name
        for field in new
        if field.renamed_from in before and field.renamed_from is not None
    }
    fresh = {
        index: field
        for index, field in enumerate(new)
        if field.name not in before and field.name not in said.values()
    }
    found: dict[Hashable, list[tuple[str, str]]] = {}
    for index, field in enumerate(old):
        other = fresh.get(index)
        if other is None or field.name in after or field.name in said:
            continue
        if (shape(field.type), _start(field)) == (shape(other.type), _start(other)):
            found.setdefault(shape(field.type), []).append((field.name, other.name))
    pairs = {one: other for group in found.values() for one, other in group}
    unclear = {one for group in found.values() if not are_alike(group) for one, _ in group}
    return pairs | said, unclear


def _start(field: Field) -> str:
    """Where the field begins; empty where that varies."""
    if field.part:
        return f"part {field.part}"
    if field.bit is not None:
        return f"bit {field.bit}"
    return "" if field.position is None else f"byte {field.position}"


def _place(
    fields: Sequence[Field],
    index: int,
    kept: set[str],
    renamed: dict[str, str] | None = None,
) -> str:
    """Where a field begins; where that varies, behind which of `kept` it stands."""
    start = _start(fields[index])
    names = [(renamed or {}).get(field.name, field.name) for field in fields[:index]]
    found = sorted(name for name in names if name in kept)
    return start or f"behind {', '.join(found) or 'nothing'}"


def _described(field: Field) -> str:
    if field.part:
        return f"{field.type.label}, part {field.part} of the frame"
    size, start = field.size, _start(field)
    bytes_ = "" if size is None else f", {size} byte{'' if size == 1 else 's'}"
    at = f" at {start}" if start else ""
    return f"{field.type.label}{at}{'' if field.bit is not None else bytes_}"


def _joined(prefix: str, name: str) -> str:
    return f"{prefix}.{name}" if prefix else name


def _shown(value: object) -> str:
    return "none" if value is None else repr(value)


def _presence(field: Field) -> str:
    match field.presence:
        case Conditional(condition=condition):
            return f"there if {condition.text}"
        case Trailing():
            return "there if it is not left out"
        case None:
            return "always there"


def _is_told_otherwise(old: Field, new: Field, types: TypeComparison) -> bool:
    """True if something else says whether the field is there."""
    match old.presence, new.presence:
        case Conditional(condition=before), Conditional(condition=after):
            return types.now(before) != after
        case before, after:
            return type(before) is not type(after)


def _bounds(field: Field) -> str:
    least = "-" if field.least is None else decimal(field.least)
    greatest = "-" if field.greatest is None else decimal(field.greatest)
    return f"{least}..{greatest}"
