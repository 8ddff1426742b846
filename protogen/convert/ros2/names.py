"""Names as ROS 2 takes them.

A field's has lower-case letters, digits, and single `_` between them; a constant's upper-case ones;
a message's words begin with capitals. Whatever else stands in a name becomes a `_`.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence

from protogen.c_language.words import foreign_words
from protogen.model.names import free_name
from protogen.runtime.attributes import KEYWORDS

_RESERVED = frozenset((*KEYWORDS.split(), *foreign_words()))
"""Words that no field may be called in the C++ and Python that ROS generates."""


def field_name(name: str) -> str:
    """A name for a field: `turn_angle` for `turn.angle`, `class_value` for `class`."""
    words = _words(name.lower())
    if not words or not words[0][0].isalpha():
        words = ["field", *words]
    found = "_".join(words)
    return f"{found}_value" if found in _RESERVED else found


def constant_name(field: str, name: str) -> str:
    """A name for a constant of a field."""
    return "_".join([field, *_words(name)]).upper()


def package_name(protocol: str) -> str:
    """A name for the package that a protocol's messages are in."""
    return field_name(protocol)


def message_name(*names: str) -> str:
    """A name for a message: `ReadMotor` for `read_motor`."""
    found = "".join(word[0].upper() + word[1:] for name in names for word in _words(name))
    return found if found[:1].isalpha() else f"Message{found}"


def _words(name: str) -> list[str]:
    return re.findall(r"[A-Za-z0-9]+", name)


def field_names(names: Sequence[str]) -> Mapping[str, str]:
    """A name for each of several fields, no two alike.

    Those that ROS takes as they are stay. Of the others, those that would be called like one in
    front get a number behind them.
    """
    found: dict[str, str] = {name: name for name in names if field_name(name) == name}
    for name in names:
        if name not in found:
            found[name] = free_name(field_name(name), set(found.values()))
    return found
