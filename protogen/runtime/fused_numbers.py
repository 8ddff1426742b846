"""Integers that `struct` does not know as parts of fused structs."""

from __future__ import annotations

from typing import Any

from protogen.runtime.fused_function import Function
from protogen.runtime.fused_parts import Convert, Item, Lists, Step, calling, looking_up
from protogen.runtime.number import Number
from protogen.runtime.pairs import PairLists, Unclear, pair_tables


def number_item(number: Number) -> Item:
    """The item of an integer that `struct` does not know."""
    wrong = f"not {number.least} <= {{v}} <= {number.greatest}"
    if number.size == 1:
        table = tuple(number.decode(bytes((byte,))) for byte in range(1 << number.bits))
        code = f"{{v}} & {(1 << number.bits) - 1}" if number.signed else "{v}"
        return Item(
            "B",
            read=looking_up(table),
            write=(Step(code, wrong),),
            counts=True,
            lists=None if number.bits < 7 or number.signed else Lists(1, _ascii_list, _ascii_bytes),
        )
    if number.seven_bit and number.size == 2:
        return _pair(number)
    read, write = calling(_joined(number)), calling(_parted(number))
    return Item(f"{number.size}s", read=read, write=write, counts=True)


def _pair(number: Number) -> Item:
    """An integer of two bytes of 7 bits each, which is looked up."""
    values, codes = pair_tables(number.bits, number.signed)
    lists = PairLists(number.bits, number.signed, number.order)
    return Item(
        "H",
        "<" if number.order == "little" else ">",
        read=looking_up(values),
        # 1.0 is found where 1 is.
        write=(Step(wrong="type({v}) is not int"), *looking_up(codes)),
        counts=True,
        lists=Lists(2, lists.decode, lambda values: lists.encode(_integers(sequence(values)))),
    )


def _integers(values: Any) -> Any:
    """The values. Raises Unclear where one is no int, but something like one."""
    if not set(map(type, values)) <= {int}:
        raise Unclear
    return values


def _ascii_list(data: bytes) -> list[int]:
    return list(ascii_only(data))


def _ascii_bytes(values: Any) -> bytes:
    return ascii_only(bytes(sequence(values)))


def ascii_only(data: bytes) -> bytes:
    """The bytes. Raises Unclear where one has its most significant bit set."""
    if not data.isascii():
        raise Unclear
    return data


def _joined(number: Number) -> Convert:
    """The function that gives the integer of its bytes."""
    function = Function("join(data)")
    function.lines.append(f"raw = int.from_bytes(data, {number.order!r})")
    if number.seven_bit:
        function.refuse_if(f"raw & {int.from_bytes(bytes((0x80,)) * number.size, 'big')}")
        groups = (f"raw >> {place} & {0x7F << 7 * place}" for place in range(number.size))
        function.lines.append(f"raw = {' | '.join(groups)}")
    function.refuse_if(f"raw >> {number.bits}")
    sign = 1 << number.bits - 1
    function.lines.append(f"return (raw ^ {sign}) - {sign}" if number.signed else "return raw")
    return function.compiled()  # type: ignore[no-any-return]


def _parted(number: Number) -> Convert:
    """The function that gives the bytes of an integer."""
    function = Function("part(value)")
    function.refuse_if(f"not {number.least} <= value <= {number.greatest}")
    function.lines.append(f"raw = value & {(1 << number.bits) - 1}")
    if number.seven_bit:
        groups = (f"(raw & {0x7F << 7 * place}) << {place}" for place in range(number.size))
        function.lines.append(f"raw = {' | '.join(groups)}")
    function.lines.append(f"return raw.to_bytes({number.size}, {number.order!r})")
    return function.compiled()  # type: ignore[no-any-return]


def sequence(values: Any) -> Any:
    """The list or tuple. Raises Unclear where it is something else."""
    if type(values) is not list and type(values) is not tuple:
        raise Unclear
    return values
