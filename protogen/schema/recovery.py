"""Parts of a schema dropped so that checking can go on.

As little as possible is dropped: a key, a field, a part, an example. Later problems may be mere
consequences, so two sets are kept. *Doubtful* items lack something that they hold or depend on.
*Lost* names are written, but can't be read, so nobody reports them as unknown.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from typing import Any

import msgspec

from protogen.schema.syntax.fields import FieldSyntax
from protogen.schema.syntax.protocol import ProtocolSyntax

Loc = tuple[str | int, ...]

_STAND_INS: dict[str, Any] = {
    "protocol": "unnamed",
    "content_covers": "payload",
    "byte_order": "little",
    "max_frame": 1 << 20,
    "messages": {},
    "frame": {},
}
"""Stand-ins for keys of the root, so that nothing seems wrong because they are missing."""
_OPTIONAL_KEYS = frozenset(
    {"title", "doc", "version", "source", "link", "exchanges", "reserved", "byte_bits"}
)
"""Keys of the root that recovery may drop."""
_WITHOUT_EFFECT = frozenset(
    {"scale", "offset", "unit", "range", "const", "default", "special", "closed", "unknown"}
    | {"doc", "source"}
)
"""Keys of a field that change neither its size nor its name."""
_LEFT_OUT = _WITHOUT_EFFECT | {"count", "size", "until", "byte_order"}
"""Keys that may be dropped and leave a field."""
_SOME_FIELD = {"type": "uint1"}
"""Stand-in for a field that can't be read: its name is still known, and it fits anywhere."""
_ITEMS = frozenset({"types", "decisions", "overloads"})
"""Keys of the root whose items others refer to."""


class Recovery(msgspec.Struct):
    """Parts of a schema dropped so that checking can go on."""

    data: dict[str, Any]
    doubtful: set[Loc] = msgspec.field(default_factory=set)
    """Items of the root that are not whole, and fields; `fields` stands for what refers to any."""
    lost: set[Loc] = msgspec.field(default_factory=set)
    """Names that can't be referred to any more; a key of the root stands for all of its names."""

    def drop(self, loc: Loc, *, unknown_key: bool) -> bool:
        """Drop what is wrong at the location of an error; False where that is not possible."""
        if len(loc) == 1:
            return not unknown_key and self._root_key(str(loc[0]))
        match loc[0]:
            case "messages":
                self._message(loc, unknown_key=unknown_key)
            case "types":
                self._type(loc, unknown_key=unknown_key)
            case "frame":
                self._frame(loc, unknown_key=unknown_key)
            case "transparency":
                self.data.pop("transparency", None)
                self.doubtful.add(("frame",))
            case "forms":
                self._form(loc, unknown_key=unknown_key)
            case "endpoints" if not unknown_key:
                self._endpoint(loc)
            case "link" | "source" | "reserved" | "exchanges":
                self._drop(loc if unknown_key else loc[:2])
                self.doubtful.add(loc[:2])
            case "decisions" | "overloads" | "endpoints":
                self._item(loc, unknown_key=unknown_key)
            case _:
                return self._root_key(str(loc[0]))
        return True

    def _root_key(self, key: str) -> bool:
        if key in _STAND_INS:
            self.data[key] = _STAND_INS[key]
        elif key in _OPTIONAL_KEYS or key in _ITEMS:
            self.data.pop(key, None)
        else:
            return False
        if key in _ITEMS:
            self.lost.add((key,))
        if key in ("messages", "frame", "overloads", "types"):
            self.doubtful.add((key,))
        if key == "byte_bits":
            self.doubtful.add(("frame",))
        return True

    def _message(self, loc: Loc, *, unknown_key: bool) -> None:
        """A message is needed to be told apart; without a sender there is no use in it."""
        if loc[2:3] == ("examples",):
            self._drop(loc[:4] if len(loc) > 3 else loc[:3])
            self.doubtful.add(("exchanges",))
            return
        if loc[2:3] == ("fields",) and len(loc) > 4:
            # Behind `fields` stands the label of a tagged union.
            self._field((*loc[:3], loc[4]), loc[5:], unknown_key=unknown_key)
            return
        self.doubtful.add(loc[:2])
        if unknown_key:
            self._drop(loc)
        elif loc[2:3] in ((), ("from",), ("[key]",)):
            self._drop(loc[:2])
        else:
            self._drop(loc[:3])

    def _field(self, place: Loc, inside: Loc, *, unknown_key: bool) -> None:
        """A field of a message is left out last: others may refer to it."""
        while len(inside) > 2 and inside[0] == "fields":
            place, inside = (*place, *inside[:2]), inside[2:]
        self.doubtful.add(place)
        if not unknown_key and inside[:1] and inside[0] in _LEFT_OUT:
            self._drop((*place, inside[0]))
            if inside[0] not in _WITHOUT_EFFECT:
                self.doubtful.add(place[:2])
            return
        self.doubtful |= {place[:2], place[:3]}
        if unknown_key:
            self._drop((*place, *inside))
        elif inside == ("[key]",):
            self._drop(place)
        else:
            _put(self.data, place, dict(_SOME_FIELD))

    def _type(self, loc: Loc, *, unknown_key: bool) -> None:
        self.doubtful.add(loc[:2])
        if unknown_key or (len(loc) > 2 and loc[2] in _LEFT_OUT):
            self._drop(loc if unknown_key else loc[:3])
        elif loc[2:3] == ("fields",) and len(loc) > 3:
            self._drop(loc[:4])
        else:
            self._drop(loc[:2])
            self.lost.add(loc[:2])

    def _frame(self, loc: Loc, *, unknown_key: bool) -> None:
        """The key of a frame that holds for all senders is empty, and not in the data."""
        self.doubtful.add(loc[:2])
        frame = self.data["frame"] if loc[1] == "" else self.data["frame"].get(loc[1])
        if not isinstance(frame, dict) or len(loc) < 3:
            self.data["frame"] = {} if loc[1] == "" else self.data["frame"] | {loc[1]: {}}
        elif unknown_key:
            _drop(frame, loc[2:])
        else:
            frame.pop(loc[2], None)

    def _form(self, loc: Loc, *, unknown_key: bool) -> None:
        """A form of frame that is left out can't be named."""
        self.doubtful |= {loc[:2], ("messages",)}
        if unknown_key:
            self._drop(loc)
        else:
            self._drop(loc[:2])
            self.lost.add(loc[:2])

    def _endpoint(self, loc: Loc) -> None:
        if "[key]" in loc:
            self._drop(loc[:2])
            self.lost.add(loc[:2])
        elif loc[1] in self.data["endpoints"]:
            self.data["endpoints"][loc[1]] = str(loc[1])

    def _item(self, loc: Loc, *, unknown_key: bool) -> None:
        self.doubtful.add(loc[:2])
        if unknown_key:
            self._drop(loc)
            return
        if loc[0] == "overloads":
            self.doubtful.update(self._listed(self.data["overloads"].get(loc[1])))
        self._drop(loc[:2])
        self.lost.add(loc[:2])

    def _listed(self, overload: Any) -> Iterator[Loc]:
        """The messages that an overload is about, as far as it says so; else all of them."""
        names = overload.get("messages") if isinstance(overload, dict) else None
        messages = self.data.get("messages")
        if not isinstance(names, list) or not isinstance(messages, dict):
            yield ("messages",)
            return
        for name in names:
            known = isinstance(name, str) and name in messages
            yield ("messages", str(name)) if known else ("messages",)

    def _drop(self, loc: Loc) -> None:
        _drop(self.data, loc)

    def consequences(self, syntax: ProtocolSyntax) -> frozenset[Loc]:
        """Everything doubtful in the rest of the schema."""
        found = {loc for loc in self.doubtful if len(loc) > 1}
        for (key,) in (loc for loc in self.doubtful if len(loc) == 1):
            found |= {(key,), *((key, name) for name in getattr(syntax, str(key)))}
        if ("overloads",) in self.doubtful or ("types",) in self.doubtful:
            found |= {("messages", name) for name in syntax.messages}
        if ("types",) in self.doubtful:
            found |= {place for place, _ in _fields(syntax)}
        found |= set(
            _users(syntax, {str(loc[1]) for loc in found if loc[0] == "types" and len(loc) > 1})
        )
        roots = {loc[0] for loc in found if len(loc) < 3}
        if "messages" in roots:
            # Sizes of messages also decide about overloads.
            found |= {("overloads", name) for name in syntax.overloads}
            found |= {("exchanges", name) for name in syntax.exchanges}
            found |= set() if syntax.messages else {("messages",)}
        if "frame" in roots:
            found |= {("content_covers",), *(("transparency", key) for key in syntax.transparency)}
        return frozenset(found)


def _drop(data: Any, loc: Sequence[str | int]) -> None:
    """Drop a key."""
    around = _around(data, loc)
    if isinstance(around, dict):
        around.pop(loc[-1], None)


def _put(data: Any, loc: Sequence[str | int], value: Any) -> None:
    """Put something in the place of what a key has."""
    around = _around(data, loc)
    if isinstance(around, dict) and loc[-1] in around:
        around[loc[-1]] = value


def _around(data: Any, loc: Sequence[str | int]) -> Any:
    """Container of the place; a step that leads nowhere is the label of a tagged union."""
    for step in loc[:-1]:
        if isinstance(data, dict):
            data = data.get(step, data)
        elif isinstance(data, list) and isinstance(step, int):
            data = data[step]
    return data


def _users(syntax: ProtocolSyntax, types: set[str]) -> Iterator[Loc]:
    """The types, messages and fields of messages that come to one of these types."""
    known = set(types)
    while True:
        more = {name for name, item in syntax.types.items() if known & set(_named([item]))} - known
        if not more:
            break
        known |= more
        yield from (("types", name) for name in more)
    for place, item in _fields(syntax):
        if known & set(_named([item])):
            yield from (place[:2], place)


def _fields(syntax: ProtocolSyntax) -> Iterator[tuple[Loc, FieldSyntax]]:
    """The fields of all messages, with their places."""
    for name, message in syntax.messages.items():
        for field_name, item in () if isinstance(message.fields, str) else message.fields.items():
            yield ("messages", name, "fields", field_name), item


def _named(items: Iterable[FieldSyntax]) -> Iterator[str]:
    """The types that are named in these fields, and in fields inside of them."""
    for item in items:
        if item.type is not None:
            yield item.type
        yield from _named((item.fields or {}).values())
        yield from _named((item.cases or {}).values())
