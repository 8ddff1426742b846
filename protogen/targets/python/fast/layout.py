"""How values of a fixed size lie in bytes, as codes of Python's `struct`."""

from __future__ import annotations

from protogen.model.sizes import SizeSet
from protogen.model.types import (
    Array,
    Counted,
    Field,
    Fill,
    Fixed,
    Float,
    Integer,
    Octets,
    Struct,
    Switch,
    Text,
    Type,
)

_UNSIGNED = {1: "B", 2: "H", 4: "I", 8: "Q"}


def code_of(type_: Type) -> str | None:
    """The code of a value that one item of `struct` holds; None where it takes more.

    A number that `struct` does not know is so many bytes, to be converted.
    """
    match type_:
        case Integer():
            return _integer(type_)
        case Float(byte_bits=8):
            return "f" if type_.bits == 32 else "d"
        case Float():
            return f"{type_.size}s"
        case Text(extent=Fixed(count=count)) | Octets(extent=Fixed(count=count)):
            return f"{count}s"
    return None


def _integer(type_: Integer) -> str:
    if type_.byte_bits == 7 and type_.size > 2:
        return f"{type_.size}s"
    code = _UNSIGNED.get(type_.size)
    if code is None:
        return f"{type_.size}s"
    return code.lower() if type_.signed and is_native(type_) else code


def is_native(type_: Integer) -> bool:
    """Whether `struct` itself reads and writes the value."""
    return type_.byte_bits == 8 and type_.bits in (8, 16, 32, 64) and type_.role != "bool"


def order_of(type_: Type) -> str:
    """`<` or `>`; empty where the order of bytes does not matter to `struct`."""
    code = code_of(type_)
    if code is None or code.endswith("s") or code in "Bb":
        return ""
    assert isinstance(type_, Integer | Float)
    return "<" if type_.byte_order == "little" else ">"


def is_named(type_: Integer) -> bool:
    """Whether the attribute is a member of an enum or a set of flags."""
    return type_.enum is not None or type_.flags is not None


def array_code(type_: Array) -> str | None:
    """The code of one element, where `struct` reads all of them as they are."""
    element = type_.element
    if isinstance(element, Integer) and is_native(element) and not is_named(element):
        return code_of(element)
    if isinstance(element, Float) and element.byte_bits == 8:
        return code_of(element)
    return None


def is_pair(type_: Type) -> bool:
    """Whether the value is one of 8 to 14 bits in two bytes of 7 bits."""
    return isinstance(type_, Integer) and type_.byte_bits == 7 and type_.size == 2


def fixed_size(type_: Type) -> int | None:
    """Wire bytes, where they do not vary."""
    return type_.sizes.fixed


def outside(sizes: SizeSet, data: str) -> str:
    """The condition that bytes are more or fewer than they can be."""
    if sizes.fixed is not None:
        return f"len({data}) != {sizes.fixed}"
    bounds = f"not {sizes.least} <= len({data}) <= {sizes.greatest}"
    return f"{bounds} or (len({data}) - {sizes.least}) % {sizes.step}" if sizes.step > 1 else bounds


def holds_records(fields: tuple[Field, ...], sizes: SizeSet) -> bool:
    """Whether these are the sizes of fields, the last of which are as many records as there are.

    Then nothing can be wrong with a size but the number of records.
    """
    last = fields[-1].type if fields else None
    others = [fixed_size(item.type) for item in fields[:-1]]
    if not isinstance(last, Array) or not isinstance(last.extent, Fill) or None in others:
        return False
    size, first = fixed_size(last.element), sum(filter(None, others))
    return bool(size) and sizes == SizeSet(
        first, first + (size or 0) * last.extent.greatest, size or 1
    )


def outer_names(struct: Struct) -> tuple[str, ...]:
    """The fields of outer records that count or select something in the struct."""
    return tuple(dict.fromkeys(_outer(struct)))


def _outer(struct: Struct) -> list[str]:
    own: set[str] = set()
    found: list[str] = []
    for field in struct.fields:
        pending: list[Type] = [field.type]
        while pending:
            type_ = pending.pop()
            if isinstance(type_, Array):
                pending.append(type_.element)
            if isinstance(type_, Switch):
                pending += [case.type for case in type_.cases]
                if type_.selector not in own:
                    found.append(type_.selector)
            if isinstance(type_, Array | Text | Octets) and isinstance(type_.extent, Counted):
                found += [name for name in (type_.extent.field,) if name not in own]
            if isinstance(type_, Struct):
                found += [name for name in _outer(type_) if name not in own]
        own.add(field.name)
    return found
