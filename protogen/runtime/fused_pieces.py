"""What the pieces of a construct declaration are as parts that go together."""

from __future__ import annotations

import keyword
import struct
from collections.abc import Callable
from typing import Any

from protogen.runtime import constructs
from protogen.runtime.constructs import Count, Extent
from protogen.runtime.fused_lists import lists_of
from protogen.runtime.fused_numbers import ascii_only, number_item, sequence
from protogen.runtime.fused_parts import (
    Chunk,
    Constant,
    Counting,
    Item,
    Lists,
    Part,
    Record,
    Several,
    Step,
    Steps,
    Unfit,
    calling,
    looking_up,
)
from protogen.runtime.number import Number
from protogen.runtime.pairs import Unclear


def part_of(format: constructs.Construct) -> Part:
    """The part that a piece is. Raises Unfit, also for what is only derived from a piece."""
    while type(format) is constructs.Renamed and format.parsed is None:
        format = format.subcon
    make = _MAKERS.get(type(format))
    if make is None or format.parsed is not None:
        raise Unfit
    return make(format)


def _item_of(format: constructs.Construct) -> Item:
    """The only item that a piece is. Raises Unfit."""
    part = _counted(format, few=0) if type(format) is constructs.Counted else part_of(format)
    if not isinstance(part, Item) or part.constant is not None:
        raise Unfit
    return part


# --- structs --------------------------------------------------------------------------------------


def record_of(format: constructs.Struct) -> Record:
    """The fields of a struct. Raises Unfit where they can't be read and written together."""
    if type(format) is not constructs.Struct or format.parsed is not None:
        raise Unfit
    _check_names([subcon.name for subcon in format.subcons])
    return Record(tuple((subcon.name, part_of(subcon)) for subcon in format.subcons))


def _check_names(names: list[str | None]) -> None:
    """Whether arguments of a function can be called so, and nothing of construct's is."""
    for name in names:
        plain = name and name.isascii() and name.isidentifier() and not keyword.iskeyword(name)
        if not plain or str(name).startswith("_"):
            raise Unfit
    if len(set(names)) < len(names):
        raise Unfit


# --- numbers --------------------------------------------------------------------------------------


def _native(format: constructs._Native) -> Item:
    order, code = format.subcon.fmtstr
    layout = f"{order}%d{code}"
    size = format.subcon.length
    lists = Lists(
        size,
        lambda data: list(struct.unpack(layout % (len(data) // size), data)),
        lambda values: struct.pack(layout % len(values), *sequence(values)),
    )
    if code == "B":
        lists = Lists(1, list, lambda values: bytes(sequence(values)))
    return Item(code, "" if size == 1 else order, counts=code not in "fd", lists=lists)


def _scalar(format: constructs._Scalar) -> Item:
    codec = format._codec
    if isinstance(codec, Number):
        return number_item(codec)
    if isinstance(codec, constructs._Boolean):
        # Whatever equals 0 or 1 is one of them, also 1.0.
        return Item("B", read=looking_up((False, True)), write=looking_up({0: 0, 1: 1}))
    return Item(f"{codec.size}s", read=calling(codec.decode), write=calling(codec.encode))


# --- values that are checked ----------------------------------------------------------------------


def _fixed(format: constructs.Fixed) -> Item:
    item, due = _item_of(format.subcon), format._value

    def same(found: Any) -> Any:
        if found != due:
            raise Unclear
        return found

    return Item(
        item.code,
        item.order,
        (*item.read, *calling(same)),
        item.write,
        counts=item.counts and type(due) is int,
        constant=Constant(due),
    )


def _closed(format: constructs.Closed) -> Item:
    item, values = _item_of(format.subcon), format._values

    def known(found: Any) -> Any:
        if found not in values:
            raise Unclear
        return found

    check = Step(wrong="{v} not in {values}", uses={"values": values})
    return Item(
        item.code,
        item.order,
        (*item.read, *calling(known)),
        (check, *item.write),
        counts=item.counts,
    )


# --- bytes and text -------------------------------------------------------------------------------


def _octets(format: constructs.Octets) -> Part:
    read, write = _of_bytes(format._seven_bit)
    return _of_extent(format._extent, 1, read, write)


def _octets_fill(format: constructs.OctetsFill) -> Chunk:
    read, write = _of_bytes(format._seven_bit)
    return Chunk(1, read, write, greatest=format._greatest)


def _of_bytes(seven_bit: bool) -> tuple[Steps, Steps]:
    """The conversions of bytes that nobody interprets."""
    check = calling(ascii_only) if seven_bit else ()
    return check, (Step(wrong="type({v}) is not bytes"), *check)


def _text(format: constructs._Text) -> Part:
    """Text that is not padded: its bytes', with characters for them."""
    octets = part_of(format.subcon)
    if not isinstance(octets, Chunk):
        raise Unfit
    check = octets.read
    return Chunk(
        1,
        (*check, Step("{v}.decode('latin-1')")),
        (Step("{v}.encode('latin-1')", wrong="type({v}) is not str"), *check),
        octets.counting,
        octets.greatest,
    )


def _padded_text(format: constructs._PaddedText) -> Item:
    size, seven_bit = format._size, format.subcon._seven_bit

    def write(value: str) -> bytes:
        data = value.encode("latin-1")
        if len(data) > size or data.endswith(b"\0"):
            raise Unclear
        return data

    check = calling(ascii_only) if seven_bit else ()
    return Item(
        f"{size}s",
        read=(*check, Step("{v}.rstrip(b'\\0').decode('latin-1')")),
        write=(Step(wrong="type({v}) is not str"), *calling(write), *check),
    )


# --- arrays ---------------------------------------------------------------------------------------


FEW = 16
"""Up to so many elements of an array are read one by one: all at once takes a call or two."""


def _counted(format: constructs.Counted, few: int = FEW) -> Part:
    count, element = format._count, part_of(format.subcon)
    if isinstance(count, int) and count <= few and isinstance(element, Item):
        return Several(count, element)
    lists = lists_of(element)
    return _of_extent(format._count, lists.size, calling(lists.read), calling(lists.write))


def _fill(format: constructs.Fill) -> Chunk:
    lists = lists_of(part_of(format.subcon))
    read, write = calling(lists.read), calling(lists.write)
    return Chunk(lists.size, read, write, greatest=format._greatest)


def _of_extent(extent: Extent, unit: int, read: Steps, write: Steps) -> Part:
    """So many units of bytes, whose value has their number as its length."""
    if isinstance(extent, int):
        check = Step(wrong=f"len({{v}}) != {extent}")
        return Item(f"{extent * unit}s", read=read, write=(*write, check))
    if isinstance(extent, Count):
        return Chunk(unit, read, write, Counting(extent.field, extent.least, extent.greatest))
    return Chunk(unit, read, write, Counting(extent))


_MAKERS: dict[type[Any], Callable[[Any], Part]] = {
    constructs.Struct: record_of,
    constructs._Native: _native,
    constructs._Scalar: _scalar,
    constructs.Fixed: _fixed,
    constructs.Closed: _closed,
    constructs.Octets: _octets,
    constructs.OctetsFill: _octets_fill,
    constructs._Text: _text,
    constructs._PaddedText: _padded_text,
    constructs.Counted: _counted,
    constructs.Fill: _fill,
}
