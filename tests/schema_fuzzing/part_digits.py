"""Numbers of a frame that are written as digits."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from hypothesis import strategies as st

from schema_fuzzing import forms

_ALPHABETS = {
    "base10": b"0123456789",
    "base16-upper": b"0123456789ABCDEF",
    "base16-lower": b"0123456789abcdef",
}
_MOST_BITS = 64


@dataclass(frozen=True, slots=True)
class Digits:
    """So many digits, by the characters that there are for each."""

    alphabet: bytes
    size: int

    @property
    def greatest(self) -> int:
        return int(len(self.alphabet) ** self.size) - 1

    def bytes_between(self, least: int, greatest: int) -> tuple[frozenset[int], ...]:
        """The characters of each digit, the highest one first."""
        base, found = len(self.alphabet), []
        for place in range(self.size):
            first, last = (bound // base**place for bound in (least, greatest))
            digits = range(first, min(last, first + base) + 1)
            found.append(frozenset(self.alphabet[digit % base] for digit in digits))
        return tuple(found[::-1])


ONE_OF_16 = {kind: Digits(_ALPHABETS[kind], 1) for kind in ("base16-upper", "base16-lower")}
"""One hexadecimal digit."""


@st.composite
def digits_of(draw: st.DrawFn, bits: int, *, whole: bool) -> tuple[Digits, dict[str, Any]]:
    """Digits for a number of so many bits, and the keys; `whole`: they hold all of its values."""
    kind = draw(st.sampled_from([*_ALPHABETS, "code"]))
    keys: dict[str, Any] = {}
    if kind == "code":
        fits = [each for each in range(1, 8) if -(-bits // each) * each <= _MOST_BITS]
        each = draw(st.sampled_from([item for item in fits if item >= min(4, bits)] or fits))
        first = draw(st.integers(0, 256 - 2**each))
        keys["code"] = {"bits": each, "add": draw(forms.raw_number(first))}
        alphabet = bytes(range(first, first + 2**each))
    else:
        alphabet = _ALPHABETS[kind]
    size = 1
    while len(alphabet) ** size < 2**bits:
        size += 1
    if len(alphabet) ** size > 2**_MOST_BITS:  # Twenty decimal digits.
        kind, keys, alphabet, size = "base16-upper", {}, _ALPHABETS["base16-upper"], 16
    if not keys:
        keys["digits"] = kind
    more = st.sampled_from([size, size + 1, size + 2] if whole else [size, size - 1, size + 1])
    size_drawn = draw(more) if draw(forms.one_in(3)) else size
    if size_drawn >= 1 and len(alphabet) ** size_drawn <= 2**_MOST_BITS and size_drawn != size:
        size = keys["chars"] = size_drawn
    elif draw(forms.one_in(6)):
        keys["chars"] = size
    return Digits(alphabet, size), keys
