"""Scopes: the mappings of a schema that may declare what a name at some place refers to."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

from protogen.model.expressions import Operand
from protogen.schema.expressions import ExpressionError, parse_expression
from protogen.schema.syntax.names import Kind
from protogen.schema.syntax.protocol import is_by_sender
from protogen.schema.text.scalars import Scalar

Place = tuple[Scalar, ...]
"""Keys and indexes that lead from the root to a node."""

_BITS = ("bits", "flags")
"""Keys that name bits of an integer."""

_EVERYWHERE = {
    Kind.ENDPOINT: "endpoints",
    Kind.TYPE: "types",
    Kind.MESSAGE: "messages",
    Kind.DECISION: "decisions",
    Kind.FORM: "forms",
}
"""Keys of the root that declare for the whole schema."""


def at(data: Any, place: Place) -> Any:
    """Value at a place of a schema's data; None if there is none."""
    for step in place:
        if isinstance(data, dict):
            data = data.get(step)
        else:
            inside = isinstance(data, list) and isinstance(step, int) and 0 <= step < len(data)
            data = data[step] if inside else None
    return data


def keys_at(data: Any, place: Place) -> tuple[Scalar, ...]:
    """Keys of the mapping at a place; anything else has none."""
    found = at(data, place)
    return tuple(found) if isinstance(found, dict) else ()


def declares(data: Any, place: Place, name: Scalar) -> bool:
    """True if the mapping at a place has such a key."""
    found = at(data, place)
    return isinstance(found, dict) and name in found


class Scopes:
    """Scopes of one schema's data; those of a name come nearest first."""

    def __init__(self, data: Any) -> None:
        self._data = data
        self._frame_by_sender = is_by_sender(data, "frame")

    def of(self, kind: Kind, owner: str | None, place: Place) -> tuple[Place, ...]:
        """Scopes of a name at a place, whose owner the key ``owner`` beside it may name."""
        match kind:
            case Kind.PART:
                return self.of_parts(place)
            case Kind.FIELD:
                return _of_fields(place)
            case Kind.EXAMPLE:
                message = self._name((*place[:-1], owner or ""))
                return (("messages", message, "examples"),)
            case Kind.VALUE if owner is None:
                return self.inside_field(place[:-1], "values")
            case Kind.VALUE:
                return self._of_cases(place[:-2], owner or "")
        return ((_EVERYWHERE[kind],),)

    def of_parts(self, place: Place) -> tuple[Place, ...]:
        """Frames that a place is about, and the parts of them whose bits are parts."""
        frames = self._of_frames(place)
        bits = (
            (*frame, part, "bits")
            for frame in frames
            for part in keys_at(self._data, frame)
            if keys_at(self._data, (*frame, part, "bits"))
        )
        return (*frames, *bits)

    def of_matched(self, keys: Sequence[str], place: Place) -> tuple[Place, ...]:
        """Fields and parts of the messages that these keys of an exchange name."""
        listed = [at(self._data, (*place[:2], key)) for key in keys]
        named = [name for item in listed for name in (item if isinstance(item, list) else [item])]
        fields = [("messages", name, "fields") for name in named if isinstance(name, str)]
        parts = (scope for place in fields for scope in self.of_parts(place))
        return tuple(dict.fromkeys((*fields, *parts)))

    def _of_frames(self, place: Place) -> tuple[Place, ...]:
        """The frame of all, or those of the senders or the forms that a place is about."""
        if keys_at(self._data, ("forms",)):
            return tuple(("forms", form, "frame") for form in self._forms(place))
        if not self._frame_by_sender:
            return (("frame",),)
        return tuple(("frame", sender) for sender in self._senders(place))

    def inside_field(self, field: Place, *keys: str) -> tuple[Place, ...]:
        """Mappings under these keys in a field, and in the declared types that it comes to."""
        return tuple(
            (*place, key)
            for place in self._meanings(field)
            for key in keys
            if keys_at(self._data, (*place, key))
        )

    def inside_path(self, path: Sequence[str], place: Place) -> tuple[Place, ...]:
        """Mappings that may declare what stands behind a dotted name: members, and bits."""
        found = self._of_path(path, place)
        keys = ("fields", *_BITS)
        return tuple(scope for field in found for scope in self.inside_field(field, *keys))

    def inside_element(self, path: Sequence[str], place: Place) -> tuple[Place, ...]:
        """Mappings that may declare what stands behind a dotted name in elements of an array.

        The place is that of a key in a mapping of the array's.
        """
        scopes = self.inside_field(place[:-2], "fields")
        for name in path:
            inside = (self.inside_field((*scope, name), "fields", *_BITS) for scope in scopes)
            scopes = tuple(scope for each in inside for scope in each)
        return scopes

    def values_of(self, path: Sequence[str], place: Place) -> tuple[Place, ...]:
        """Mappings that may declare the values of what a dotted name stands for."""
        found = self._of_path(path, place)
        keys = ("values", "special")
        return tuple(scope for field in found for scope in self.inside_field(field, *keys))

    def _of_path(self, path: Sequence[str], place: Place) -> list[Place]:
        """Places of a field, or of bits of one, that a dotted name at some place may mean."""
        scopes, found = _of_fields(place), list[Place]()
        for name in path:
            found = [(*scope, name) for scope in scopes if name in keys_at(self._data, scope)][:1]
            inner = (self.inside_field(field, "fields", *_BITS) for field in found)
            scopes = tuple(scope for each in inner for scope in each)
        return found

    def _of_cases(self, field: Place, switch: str) -> tuple[Place, ...]:
        """Values of what chooses between the cases of a field."""
        written = at(self._data, (*field, switch))
        try:
            chosen = parse_expression(written) if isinstance(written, str) else None
        except ExpressionError:
            return ()
        return self.values_of(chosen.path, (*field, switch)) if isinstance(chosen, Operand) else ()

    def _senders(self, place: Place) -> list[Scalar]:
        """Senders of the nearest mapping that says so; else all of them."""
        frames = keys_at(self._data, ("frame",))
        if place[0] in ("frame", "transparency") and place[1] in frames:
            return [place[1]]
        for steps in range(len(place) - 1, 1, -1):
            senders = at(self._data, (*place[:steps], "from"))
            if senders is not None:
                listed = senders if isinstance(senders, list) else [senders]
                return [sender for sender in listed if isinstance(sender, str)]
        return list(frames)

    def _forms(self, place: Place) -> list[Scalar]:
        """Forms of the nearest mapping that says so; else all of them."""
        forms = keys_at(self._data, ("forms",))
        if place[0] == "forms" and place[1] in forms:
            return [place[1]]
        named = at(self._data, (*place[:2], "forms")) if place[0] == "messages" else None
        listed = named if isinstance(named, list) else [named]
        return [form for form in listed if form in forms] or list(forms)

    def _meanings(self, field: Place) -> Iterator[Place]:
        """Yield a field's place and those of its declared type, of that one's type, and so on."""
        seen: set[Place] = set()
        while field not in seen and (written := at(self._data, field)) is not None:
            yield field
            seen.add(field)
            named = written.get("type") if isinstance(written, dict) else written
            field = ("types", named) if isinstance(named, str) else field

    def _name(self, place: Place) -> str | None:
        written = at(self._data, place)
        return written if isinstance(written, str) else None


def _of_fields(place: Place) -> tuple[Place, ...]:
    """Mappings of fields around a place. Keys and names alternate: a field may be called so."""
    around = range(len(place) - len(place) % 2 - 2, 1, -2)
    return tuple(place[: step + 1] for step in around if place[step] == "fields")
