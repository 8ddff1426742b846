"""Names of MAVLink -> names of a schema."""

from __future__ import annotations

from collections.abc import Sequence

from protogen.importing.names import snake_case


def identifier(name: str) -> str:
    """Return a name in lower snake case: `GPS_2D` is `gps_2d`, `rollRate` is `roll_rate`."""
    return snake_case(name.lower() if name.isupper() else name)


def common_prefix(enum: str, entries: Sequence[str]) -> str:
    """Return what all entries of an enum begin with: its name, or else the words in common.

    It ends with `_`, or is empty.
    """
    own = f"{enum}_"
    if all(entry.startswith(own) and entry != own for entry in entries):
        return own
    compared = entries if len(entries) > 1 else (*entries, own)
    common: list[str] = []
    for words in zip(*(entry.split("_")[:-1] for entry in compared), strict=False):
        if len(set(words)) > 1:
            break
        common.append(words[0])
    return "".join(f"{word}_" for word in common)


def short_name(entry: str, prefix: str) -> str:
    """Return the name of an entry without the prefix.

    Where it would begin with a digit, the last word of the prefix stays: `resolution_480p`.
    """
    if not entry.startswith(prefix):
        return identifier(entry)
    rest = entry.removeprefix(prefix)
    if rest[:1].isdigit() and prefix:
        return identifier(f"{prefix.rstrip('_').rpartition('_')[2]}_{rest}")
    return identifier(rest)
