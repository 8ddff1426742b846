"""Frames where they stand in a schema that was drawn, and the messages that are in them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

Data = dict[str, Any]


@dataclass(frozen=True, slots=True)
class Placed:
    """A frame in its place, and whose it is."""

    holder: Data
    key: str
    senders: frozenset[str]
    form: str = ""

    @property
    def parts(self) -> Data:
        """The parts by name."""
        found: Data = self.holder[self.key]
        return found

    def put(self, parts: Data) -> None:
        """Put others in their place."""
        self.holder[self.key] = parts

    def carries(self, message: Data) -> bool:
        """True if frames of this kind have the message."""
        listed = message.get("forms", [self.form])
        forms = [listed] if isinstance(listed, str) else listed
        return self.form in forms and not self.senders.isdisjoint(senders_of(message))

    def with_part(self, place: int, name: str, part: Data) -> Data:
        """The parts with one more among them; nothing stands behind a silence."""
        items = list(self.parts.items())
        last = len(items) - ("idle" in items[-1][1])
        items.insert(min(place, last), (name, part))
        return dict(items)


def senders_of(message: Data) -> list[str]:
    """Names of the endpoints that send a message."""
    listed: str | list[str] = message["from"]
    return [listed] if isinstance(listed, str) else listed


def placed_frames(data: Data) -> list[Placed]:
    """All frames of a schema."""
    everybody = frozenset(data["endpoints"])
    if "forms" in data:
        return [
            Placed(form, "frame", frozenset(senders_of({"from": [*everybody], **form})), name)
            for name, form in data["forms"].items()
        ]
    frame = data["frame"]
    if "payload" in frame:
        return [Placed(data, "frame", everybody)]
    return [Placed(frame, sender, frozenset({sender})) for sender in frame]


def names_of_parts(data: Data) -> set[str]:
    """Names of the parts of all frames, and of their bits."""
    return {name for placed in placed_frames(data) for name in _names(placed.parts)}


def _names(parts: Data) -> Iterator[str]:
    for name, part in parts.items():
        yield name
        yield from part.get("bits", ())
