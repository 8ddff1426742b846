"""Numbers that tell parts of other frames, which two versions may name differently."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping

from protogen.evolution.compare_fields import renames
from protogen.evolution.compare_frames import renamed_parts
from protogen.model.frame import Frame
from protogen.model.messages import Message


def renamed_tellers(
    frames: Iterable[tuple[Frame, Frame]], messages: Iterable[tuple[Message, Message]]
) -> Mapping[str, str]:
    """New names of what `set_by` names, by the old ones; each pair is of the same in both."""
    found: dict[str, set[str]] = {}
    for name, other in (*_parts(frames), *_fields(messages)):
        found.setdefault(name, set()).add(other)
    # A part that has a new name in some frames alone still tells what it told in the others.
    return {name: others.pop() for name, others in found.items() if len(others) == 1}


def _parts(frames: Iterable[tuple[Frame, Frame]]) -> Iterator[tuple[str, str]]:
    for old, new in frames:
        renamed = renamed_parts(old, new)
        for part in old.shown_parts:
            yield part.name, renamed.get(part.name, part.name)


def _fields(messages: Iterable[tuple[Message, Message]]) -> Iterator[tuple[str, str]]:
    for old, new in messages:
        renamed, _ = renames(old.fields, new.fields)
        for field in old.fields:
            yield (
                f"{old.name}.{field.name}",
                f"{new.name}.{renamed.get(field.name, field.name)}",
            )
