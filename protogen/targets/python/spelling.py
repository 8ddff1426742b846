"""How the schema's names are spelled in Python.

Everything that a generated module uses comes from modules imported whole (`rt`, `typing`, ...), so
a class name can't hide anything.
"""

from __future__ import annotations

import re

_UNIT_WORDS = {"%": "percent", "/": " per ", "^": " ", "°": " deg ", "µ": "u", "Ω": " ohm "}


def class_name(name: str) -> str:
    """`move_manual` is `MoveManual`."""
    return "".join(word[:1].upper() + word[1:] for word in name.split("_"))


def member_name(name: str) -> str:
    """`left_button` is `LEFT_BUTTON`."""
    return name.upper()


def unit_suffix(unit: str | None) -> str:
    """`mm/s` is `mm_per_s`; what has no letters at all is `scaled`."""
    text = unit or ""
    for sign, word in _UNIT_WORDS.items():
        text = text.replace(sign, word)
    words = re.findall(r"[A-Za-z0-9]+", text)
    return "_".join(words).lower() or "scaled"
