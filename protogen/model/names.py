"""Names that stand beside those of a schema."""

from __future__ import annotations

import re
from collections.abc import Collection

_UNIT_WORDS = {"%": "percent", "/": " per ", "^": " ", "°": " deg ", "µ": "u", "Ω": " ohm "}


def free_name(name: str, taken: Collection[str], between: str = "_") -> str:
    """The name, or with the first number behind it that makes it one that is not taken."""
    found, number = name, 2
    while found in taken:
        found, number = f"{name}{between}{number}", number + 1
    return found


def unit_suffix(unit: str | None) -> str:
    """The name of a unit: `mm_per_s` for `mm/s`, `scaled` for what has no letters."""
    text = unit or ""
    for sign, word in _UNIT_WORDS.items():
        text = text.replace(sign, word)
    words = re.findall(r"[A-Za-z0-9]+", text)
    return "_".join(words).lower() or "scaled"
