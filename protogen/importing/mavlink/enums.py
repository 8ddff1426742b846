"""Enums of dialects -> named types of schemas, as wide as the fields that use them.

A file may add entries to an enum of one that it includes, and use it in fields of another width. A
type has one width; so an enum is a type for each, of which the first has its name.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import msgspec

from protogen.importing.mavlink.identifiers import common_prefix, identifier, short_name
from protogen.importing.mavlink.spec import Entry, Enum
from protogen.importing.mavlink.texts import entry_text, life_text
from protogen.importing.names import LONGEST_NAME, says_all, unique
from protogen.importing.remarks import DefinitionError, Kind, Remark
from protogen.importing.schema_text import joined, paragraphs
from protogen.problems import hint_for
from protogen.problems.span import Span

INTEGERS = {
    f"{sign}int{bits}_t": f"{name}int{bits}"
    for bits in (8, 16, 32, 64)
    for sign, name in (("u", "u"), ("", "s"))
}
"""Types of integers, and what a schema calls them."""


class Variant(msgspec.Struct):
    """Type of a schema: an enum in the width of some fields."""

    name: str
    type: str
    is_used: bool
    """False for one that stands there for readers, as no field has it."""


class Named(msgspec.Struct, frozen=True):
    """Entry of an enum, under its name in a schema."""

    name: str
    number: int
    text: str
    entry: Entry


class EnumTypes(msgspec.Struct):
    """All that the schemas of a dialect and of those that it includes say of an enum."""

    enum: Enum
    file: str
    prefix: str
    has_flags: bool
    """True if its entries are single bits; False if they are numbers."""
    entries: dict[str, Named]
    """Entries by their name in definitions."""
    variants: dict[str, Variant]
    """Types by that of their number."""
    new: list[Named]
    """Entries that the schema adds to those that it extends."""
    uses: Counter[str]
    """Types of the fields that the schema adds."""

    def copied(self) -> EnumTypes:
        """Return it as a schema that extends this one finds it."""
        variants = {
            key: Variant(item.name, item.type, item.is_used) for key, item in self.variants.items()
        }
        return EnumTypes(
            self.enum,
            self.file,
            self.prefix,
            self.has_flags,
            dict(self.entries),
            variants,
            [],
            Counter(),
        )

    def value_of(self, name: str) -> int | None:
        """Return the number of an entry, if there is one of this name."""
        named = self.entries.get(name)
        return None if named is None else named.number


class Enums:
    """Enums of a schema."""

    def __init__(self, base: Enums | None, remarks: list[Remark]) -> None:
        self._remarks = remarks
        known = {} if base is None else base.by_name
        self.by_name: dict[str, EnumTypes] = {name: item.copied() for name, item in known.items()}

    def add(self, enum: Enum, file: str) -> None:
        """Add an enum of a file, or its entries to the enum that is there."""
        types = self.by_name.get(enum.name)
        if types is None:
            prefix = common_prefix(enum.name, [entry.name for entry in enum.entries])
            greatest = max((entry.value or 0 for entry in enum.entries), default=0)
            has_flags = enum.is_bitmask and greatest > 1
            types = EnumTypes(enum, file, prefix, has_flags, {}, {}, [], Counter())
            self.by_name[enum.name] = types
        is_new = not types.entries
        for entry, number in _numbered(enum, types):
            self._add_entry(types, entry, number)
            if entry.value is None and not is_new:
                reason = f"it has no value, and is {number} behind those of other files"
                self._remark(Kind.CHANGED, types, entry, reason)

    def _add_entry(self, types: EnumTypes, entry: Entry, number: int) -> None:
        for other in types.entries.values():
            if entry.name == other.entry.name or number == other.number:
                place = f"{Path(other.entry.span.file).name}:{other.entry.span.line}"
                message = f"{types.enum.name} has `{other.entry.name}`, {other.number}, in {place}"
                hint = "names and values stand once, in all files that include each other"
                raise DefinitionError(entry.span, message, hint)
        taken = {item.name for item in types.entries.values()}
        name = unique(short_name(entry.name, types.prefix), taken)
        named = Named(name, number, entry_text(entry), entry)
        types.entries[entry.name] = named
        types.new.append(named)
        if types.has_flags and not _is_bit(number):
            what = "it is no bit" if number <= 0 else "it has several bits"
            reason = f"{number} is no flag, {what}; the doc of the type has it"
            self._remark(Kind.CHANGED, types, entry, reason)

    def use(self, name: str, number: str, span: Span) -> None:
        """Note that a field of a message is an enum. Raises DefinitionError if there is none."""
        if name not in self.by_name:
            hint = hint_for(name, self.by_name) or "define it here, or in an included file"
            raise DefinitionError(span, f"there is no enum `{name}`", hint)
        if can_name(self.by_name[name], number):
            self.by_name[name].uses[number] += 1

    def type_of(self, name: str, number: str) -> str | None:
        """Return the type of a field that is an enum, or None if its numbers can't have names."""
        variant = self.by_name[name].variants.get(number)
        return None if variant is None else variant.name

    def types(self, taken: set[str]) -> dict[str, Any]:
        """Return the types that the schema adds or changes; none is called as in `taken`."""
        data: dict[str, Any] = {}
        for types in self.by_name.values():
            known = {item.name for item in types.variants.values()}
            changed = self._fitted(types, taken)
            for variant in types.variants.values():
                body = self._type(types, variant, is_new=variant.name not in known)
                if variant.name in changed:
                    body = {"type": variant.type} | body
                if body:
                    data[variant.name] = body
                taken.add(variant.name)
        return data

    def _fitted(self, types: EnumTypes, taken: set[str]) -> set[str]:
        """Give an enum a type for each width that is needed; return those with another width."""
        base = identifier(types.enum.name)
        needed = [number for number, _ in types.uses.most_common() if number not in types.variants]
        needed.sort(key=lambda number: not _fits_all(types, number))
        changed: set[str] = set()
        unused = [
            item
            for number, item in types.variants.items()
            if not item.is_used and number not in types.uses
        ]
        for variant in unused:
            # No field has it, so its width may follow the first one that does.
            wanted = needed[0] if needed else _smallest(types)
            if _fits_all(types, wanted) and wanted != _key(variant.type):
                del types.variants[_key(variant.type)]
                variant.type = INTEGERS[wanted]
                types.variants[wanted] = variant
                changed.add(variant.name)
            needed = [number for number in needed if number not in types.variants]
        if not types.variants and not needed:
            needed = [_smallest(types)]
        for number in needed:
            kind = INTEGERS[number]
            wide = f"{base[: LONGEST_NAME - len(kind) - 1].rstrip('_')}_{kind}"
            name = unique(wide, taken) if types.variants else unique(base, taken, "type")
            types.variants[number] = Variant(name, kind, is_used=False)
        for number in types.uses:
            types.variants[number].is_used = True
        return changed

    def _type(self, types: EnumTypes, variant: Variant, *, is_new: bool) -> dict[str, Any]:
        entries = types.entries.values() if is_new else types.new
        names = self._names(types, variant, entries)
        key = "flags" if types.has_flags else "values"
        body: dict[str, Any] = {key: names} if names else {}
        if not is_new:
            return body
        first, last = types.enum.span.line, types.enum.last_line
        lines = str(first) if first == last else f"{first}-{last}"
        doc = _doc(types)
        return {
            "type": variant.type,
            **body,
            **({"doc": doc} if doc else {}),
            "source": {"document": Path(types.file).name, "lines": lines},
        }

    def _names(
        self, types: EnumTypes, variant: Variant, entries: Iterable[Named]
    ) -> dict[str, Any]:
        names: dict[str, Any] = {}
        for item in entries:
            if types.has_flags and not _is_bit(item.number):
                continue
            if not _fits(item.number, variant.type):
                reason = f"{item.number} does not fit in the {variant.type} of `{variant.name}`"
                self._remark(Kind.LEFT_OUT, types, item.entry, reason)
                continue
            key = "bit" if types.has_flags else "value"
            number = item.number.bit_length() - 1 if types.has_flags else item.number
            is_said = not item.text or says_all(item.name, item.text)
            names[item.name] = number if is_said else {key: number, "doc": item.text}
        return names

    def _remark(self, kind: Kind, types: EnumTypes, entry: Entry, reason: str) -> None:
        self._remarks.append(Remark(kind, f"{types.enum.name}.{entry.name}", reason, entry.span))


def can_name(types: EnumTypes, number: str) -> bool:
    """True if numbers of a type can have the names of an enum: integers, without sign for bits."""
    return number in INTEGERS and not (types.has_flags and INTEGERS[number].startswith("s"))


def _numbered(enum: Enum, types: EnumTypes) -> list[tuple[Entry, int]]:
    """Return entries with their numbers, as mavgen finds them.

    One without is greater by one than all so far, and than all that other files have, if the
    numbers of this one lie among those.
    """
    numbers: list[int] = []
    for entry in enum.entries:
        follows = max([0, *numbers]) + 1
        numbers.append(follows if entry.value is None else entry.value)
    others = [item.number for item in types.entries.values()]
    if others and numbers and min(numbers) <= max(others) and max(numbers) >= min(others):
        greatest = max(others)
        for index, entry in enumerate(enum.entries):
            if entry.value is None and numbers[index] <= greatest:
                greatest += 1
                numbers[index] = greatest
    return list(zip(enum.entries, numbers, strict=True))


def _is_bit(number: int) -> bool:
    return number > 0 and number.bit_count() == 1


def _fits(number: int, kind: str) -> bool:
    bits = int(kind.removeprefix("sint").removeprefix("uint"))
    if kind.startswith("s"):
        return -(1 << bits - 1) <= number < 1 << bits - 1
    return 0 <= number < 1 << bits


def _fits_all(types: EnumTypes, number: str) -> bool:
    return all(_fits(item, INTEGERS[number]) for item in _numbers(types))


def _smallest(types: EnumTypes) -> str:
    """Return the narrowest type that holds all entries; the widest one if there is none."""
    is_signed = any(number < 0 for number in _numbers(types))
    kinds = [f"{'' if is_signed else 'u'}int{bits}_t" for bits in (8, 16, 32, 64)]
    return next((kind for kind in kinds if _fits_all(types, kind)), kinds[-1])


def _numbers(types: EnumTypes) -> list[int]:
    """Return the numbers that a type has names for."""
    numbers = [item.number for item in types.entries.values()]
    return list(filter(_is_bit, numbers)) if types.has_flags else numbers


def _key(kind: str) -> str:
    return next(number for number, name in INTEGERS.items() if name == kind)


def _doc(types: EnumTypes) -> str:
    """Return what a type is about, with what its names lack."""
    enum = types.enum
    shown = f"{identifier(enum.name)}_" == identifier(f"{types.prefix}x")[:-1]
    begin = f"Names begin with {types.prefix} in MAVLink." if types.prefix and not shown else ""
    others = [
        f"{item.entry.name} is {item.number}{f': {item.text}' if item.text else ''}"
        for item in types.new
        if types.has_flags and not _is_bit(item.number)
    ]
    return joined([paragraphs(enum.text), life_text(enum.life), begin, *others])
