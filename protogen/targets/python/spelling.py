"""The schema's names as Python spells them.

Everything that a generated module uses comes from modules imported whole (`rt`, `typing`, ...), so
a class name can't hide anything.
"""

from __future__ import annotations

from functools import lru_cache


@lru_cache(4096)
def class_name(name: str) -> str:
    """`move_manual` is `MoveManual`; `_` at the end stays."""
    words = name.rstrip("_")
    spelled = "".join(word[:1].upper() + word[1:] for word in words.split("_"))
    return spelled + name[len(words) :]


def member_name(name: str) -> str:
    """`left_button` is `LEFT_BUTTON`."""
    return name.upper()
