"""Names of definitions -> names of a schema: lower snake case, at most 64 characters, unique."""

from __future__ import annotations

import re
from collections.abc import Collection

from protogen.schema.dialects.directives import DIRECTIVES

LONGEST_NAME = 64
LONGEST_LABEL = 40
"""Characters of a name that is made of a description."""
_LONGEST_BASE = LONGEST_NAME - 21
"""Characters of a name that a number may stand behind, of up to 20 digits."""

_SIGNED = re.compile(r"[-+/<>=] ?\d")
"""Number that is another one without what stands in front of it."""
_CAMEL = re.compile(r"(?<=[a-z0-9])(?=[A-Z])|(?<=[A-Z])(?=[A-Z][a-z])")


def snake_case(name: str) -> str:
    """Return an identifier in lower snake case: `GnssSignal` is `gnss_signal`."""
    return _joined(re.split(r"[^a-z0-9]+", _CAMEL.sub("_", name).lower()), LONGEST_NAME)


def label(text: str) -> str:
    """Return a name that is made of the first words of a description."""
    return _joined(re.findall(r"[a-z0-9]+", text.lower()), LONGEST_LABEL)


def says_all(name: str, text: str) -> bool:
    """True if a name tells all words of the description that it is made of."""
    words = re.findall(r"[a-z0-9]+", text.lower())
    return words == name.split("_") and _SIGNED.search(text) is None


def _joined(words: list[str], longest: int) -> str:
    """Return the words that fit, with `_` between them; a name begins with a letter."""
    words = [word for word in words if word]
    if not words:
        return "unnamed"
    if words[0][0].isdigit():
        words = ["n", *words]
    name = words[0][:longest]
    for word in words[1:]:
        if len(name) + 1 + len(word) > longest:
            break
        name += f"_{word}"
    return name


def unique(name: str, taken: Collection[str], suffix: str | None = None) -> str:
    """Return the name, with a number or `suffix` behind it where it is taken already.

    A word that a dialect has a meaning for becomes a `_value`.
    """
    if name in DIRECTIVES:
        name = f"{name}_value"
    if name not in taken:
        return name
    base = name[:_LONGEST_BASE].rstrip("_")
    number = 2
    tried = f"{base}_{number if suffix is None else suffix}"
    while tried in taken:
        number += 1
        tried = f"{base}_{number}"
    return tried
