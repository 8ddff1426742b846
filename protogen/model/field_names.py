"""Names for what stands beside a field: how many elements it has, and whether it is there."""

from __future__ import annotations

from collections.abc import Sequence

from protogen.model.names import free_name
from protogen.model.types import Array, Field, needed_by


def count_name(fields: Sequence[Field], field: Field) -> str:
    """Name beside those of `fields` for the number of elements or bytes of one that has it.

    It hides none of the numbers around that they ask for.
    """
    word = "count" if isinstance(field.type, Array) else "size"
    around = {path.partition(".")[0] for path in needed_by(fields)}
    return free_name(f"{field.name}_{word}", {item.name for item in fields} | around)


def presence_name(fields: Sequence[Field], field: Field) -> str:
    """Name beside those of `fields`, and of their counts, for whether an optional one is there."""
    counts = {count_name(fields, item) for item in fields if item.has_count}
    return free_name(f"has_{field.name}", {item.name for item in fields} | counts)
