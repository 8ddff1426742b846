"""Numbers, sizes, ranges and names in words."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from functools import lru_cache

from protogen.model.sizes import SizeSet

_LONG = 1 << 16
"""Bounds from here on are written as powers of two where they are some."""


def code(text: object) -> str:
    """Print a name or a number as code. Not for free text: nothing is escaped."""
    return f"`{text}`"


def hex_bytes(data: bytes) -> str:
    """Print bytes as pairs of hex digits: ``1B 02``."""
    return data.hex(" ").upper()


def hex_number(value: int, bits: int) -> str:
    """Print a raw value in hex, as wide as its type; a negative one as its two's complement."""
    return f"0x{value & ((1 << bits) - 1):0{-(-bits // 4)}X}"


def short_number(value: int) -> str:
    """Print a number in decimal where that is the same in hex, or negative, else in hex."""
    return str(value) if value < 10 else f"0x{value:02X}"


def number(value: Fraction) -> str:
    """Print an exact number: as a decimal where that ends, else as a fraction."""
    twos, rest = _without(value.denominator, 2)
    fives, rest = _without(rest, 5)
    if rest != 1:
        return f"{value.numerator}/{value.denominator}"
    places = max(twos, fives)
    digits = f"{abs(value.numerator) * 10**places // value.denominator:0{places + 1}d}"
    sign = "-" if value < 0 else ""
    return f"{sign}{digits[:-places]}.{digits[-places:]}" if places else f"{sign}{digits}"


def _without(value: int, prime: int) -> tuple[int, int]:
    """Count how often `prime` divides `value`, and return what is left."""
    power = 0
    while value % prime == 0:
        value, power = value // prime, power + 1
    return power, value


def bounds(least: Fraction | None, greatest: Fraction | None) -> str:
    """Print a range, both ends included; an end that is None is open."""
    return f"{_bound(least)}..{_bound(greatest)}"


def _bound(value: Fraction | None) -> str:
    if value is None:
        return ""
    if value.denominator == 1 and abs(value.numerator) >= _LONG:
        return _power(value.numerator)
    return number(value)


def _power(value: int) -> str:
    if value > 0 and (value + 1).bit_count() == 1:
        return f"2^{value.bit_length()}-1"
    if value < 0 and value.bit_count() == 1:
        return f"-2^{value.bit_length() - 1}"
    return str(value)


@lru_cache(maxsize=1024)
def size_text(sizes: SizeSet) -> str:
    """Print the possible sizes: ``8``, ``0 to 255``, ``8 to 59 in steps of 3``."""
    return f"{_ends(sizes)}{_steps(sizes)}"


def _ends(sizes: SizeSet) -> str:
    if sizes.fixed is not None:
        return str(sizes.fixed)
    joint = "or" if sizes.greatest - sizes.least == sizes.step else "to"
    return f"{sizes.least} {joint} {sizes.greatest}"


def _steps(sizes: SizeSet) -> str:
    two = sizes.greatest - sizes.least <= sizes.step
    return "" if sizes.step < 2 or two else f" in steps of {sizes.step}"


def plural(count: int | SizeSet, noun: str) -> str:
    """Print a number of things: ``1 byte``, ``2 bytes``, ``0 to 3 bytes``."""
    sizes = SizeSet.exactly(count) if isinstance(count, int) else count
    return f"{_ends(sizes)} {noun}{'' if sizes.fixed == 1 else 's'}{_steps(sizes)}"


def span(start: int, size: int) -> str:
    """Print where `size` bytes from `start` lie: ``7`` or ``2..3``."""
    return str(start) if size <= 1 else f"{start}..{start + size - 1}"


def bit_span(first: int, count: int) -> str:
    """Print which bits these are: ``bit 7`` or ``bits 2..3``."""
    return f"bit{'' if count == 1 else 's'} {span(first, count)}"


def rate(per_second: Fraction) -> str:
    """Print a rate, rounded down: whole from ten on, else to a tenth."""
    return str(int(per_second)) if per_second >= 10 else number(Fraction(int(per_second * 10), 10))


def how_often(hertz: Fraction) -> str:
    """Print how often something is sent: ``50 times a second``, or ``every 2.5 s``."""
    if hertz.denominator == 1:
        return "once a second" if hertz == 1 else f"{hertz} times a second"
    period = 1 / hertz
    seconds, short = number(period), number(period * 1000)
    if "/" in short:
        return f"{number(hertz)} times a second"
    return f"every {seconds} s" if period >= 1 else f"every {short} ms"


def listed(items: Sequence[str], last: str = "and") -> str:
    """Join items as prose does: ``a``, ``a and b``, ``a, b and c``."""
    if len(items) < 2:
        return "".join(items)
    return f"{', '.join(items[:-1])} {last} {items[-1]}"


def capital(text: str) -> str:
    """Begin a text with a capital letter."""
    return text[:1].upper() + text[1:]


def sentence(text: str) -> str:
    """End a text with a full stop, unless it ends a sentence already."""
    return text if not text or text.endswith((".", "!", "?", ":")) else f"{text}."


def sentences(*texts: str) -> str:
    """Join texts, each a sentence; empty ones are left out."""
    return " ".join(sentence(text) for text in texts if text)
