"""Runs of bits as lists of 0 and 1, in the order in which a schema counts them."""

from __future__ import annotations

from collections.abc import Iterable, Sequence


def bits_of(data: bytes, order: str) -> list[int]:
    """All bits of some bytes."""
    places = range(8) if order == "lsb_first" else range(7, -1, -1)
    return [byte // 2**place % 2 for byte in data for place in places]


def bytes_of(bits: Sequence[int], order: str) -> bytes:
    """The bytes that have these bits; those behind the last one are 0."""
    padded = [*bits, *[0] * (-len(bits) % 8)]
    eights = [padded[start : start + 8] for start in range(0, len(padded), 8)]
    return bytes(number_of(eight, order) for eight in eights)


def number_of(bits: Iterable[int], order: str) -> int:
    """The unsigned number that has these bits."""
    ordered = bits if order == "msb_first" else reversed([*bits])
    number = 0
    for bit in ordered:
        number = 2 * number + bit
    return number


def bits_of_number(value: int, count: int, order: str) -> list[int]:
    """So many bits of a number, which is two's complement where it is negative."""
    bits = [value % 2**count // 2**place % 2 for place in range(count)]
    return bits if order == "lsb_first" else bits[::-1]
