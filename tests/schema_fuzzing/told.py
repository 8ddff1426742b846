"""Parts that are told, and not sent, put into a schema that was drawn."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Any

from hypothesis import strategies as st

from schema_fuzzing import forms
from schema_fuzzing.names import PARTS, fresh
from schema_fuzzing.placed import Data, Placed, names_of_parts, placed_frames, senders_of

_ROOM = 64
"""Bits that all identity parts have at most."""


def add_told(draw: st.DrawFn, data: Data) -> None:
    """Put a told part into some frame whose senders share no message with others."""
    if not draw(forms.one_in(4)):
        return
    fitting = [
        placed
        for placed in placed_frames(data)
        if _is_alone(data, placed) and _can_be_told(placed.parts)
    ]
    if not fitting:
        return
    placed = draw(st.sampled_from(fitting))
    name = draw(fresh(PARTS, names_of_parts(data)))
    _identify(draw, data, placed, name)
    data.get("reserved", {}).pop("identities", None)  # These would have a value of it, too.
    part = _telling(draw, draw(st.sampled_from(["uint8", "uint16", "uint32"])), 255)
    tellers = list(_tellers(data, placed, int(part["type"].removeprefix("uint"))))
    if tellers and draw(st.booleans()):
        chosen = draw(st.lists(st.sampled_from(tellers), min_size=1, max_size=2, unique=True))
        part["set_by"] = chosen[0] if len(chosen) == 1 and draw(st.booleans()) else chosen
    place = draw(st.integers(0, len(placed.parts)))
    placed.put(placed.with_part(place, name, part))


def _tellers(data: Data, placed: Placed, bits: int) -> Iterator[str]:
    """Numbers of such a width in what others send, who thereby tell the part."""
    own = set(placed.parts)
    for other in placed_frames(data):
        if other.senders.isdisjoint(placed.senders):
            for name, part in other.parts.items():
                if name not in own and _is_number(part, bits) and _ROLES & part.keys():
                    yield name
    for name, message in data["messages"].items():
        if (
            placed.senders.isdisjoint(senders_of(message))
            and message.get("fields", "unspecified") != "unspecified"
        ):
            for key, field in message["fields"].items():
                if _is_number({"type": field} if isinstance(field, str) else field, bits):
                    yield f"{name}.{key}"


_ROLES = {"id", "counter", "default"}


def _is_number(written: Data, bits: int) -> bool:
    width = re.fullmatch(r"uint(\d+)", written.get("type", ""))
    plain = not {"bits", "flags", "values", "packed", "algorithm", "virtual"} & written.keys()
    return plain and width is not None and int(width[1]) <= bits


def add_told_length(draw: st.DrawFn, data: Data) -> None:
    """Put a told length into some frames that have none, and that nothing is stuffed in."""
    for placed in placed_frames(data):
        stuffed = placed.holder.get("transparency") or data.get("transparency", {})
        is_stuffed = placed.senders & set(stuffed) or (stuffed and placed.key == "frame")
        if is_stuffed or not _takes_a_length(placed.parts) or draw(forms.one_in(2)):
            continue
        part = {**_telling(draw, "uint16", 3000), **draw(_counted(placed.parts))}
        name = draw(fresh(PARTS, names_of_parts(data)))
        placed.put(placed.with_part(draw(st.integers(0, len(placed.parts))), name, part))


def _takes_a_length(parts: Data) -> bool:
    """True if a length changes nothing about how frames start, and none is without bytes."""
    every = [*parts.values(), *(it for part in parts.values() for it in _bits_of(part))]
    if any("counts" in part or "idle" in part for part in every):
        return False
    first, *_, last = parts.values()
    ends = [part["literal"] for part in (first, last) if "literal" in part]
    plain = [forms.bytes_of_octets(end) for end in ends if not _is_choice(end)]
    if len(plain) == 2 and plain[0] == plain[1]:
        return False
    is_marked = "literal" in first or not any(key in first for key in ("range", "bits"))
    return is_marked and any(_is_always_there(part) for part in parts.values())


def _is_choice(literal: Any) -> bool:
    return isinstance(literal, dict) and "any_of" in literal


def _is_always_there(part: Data) -> bool:
    return "literal" in part or ("type" in part and "when" not in part and "told" not in part)


def _bits_of(part: Data) -> list[Data]:
    return [item for item in part.get("bits", {}).values() if isinstance(item, dict)]


@st.composite
def _counted(draw: st.DrawFn, parts: Data) -> Data:
    """What a length counts: some parts that are sent, the payload among them."""
    sent = [name for name, part in parts.items() if not {"told", "virtual"} & part.keys()]
    chosen = [name for name in sent if name == "payload" or draw(forms.one_in(3))]
    return {"counts": draw(forms.run(chosen, sent))}


def _telling(draw: st.DrawFn, type_: str, greatest: int) -> Data:
    part: Data = {"type": type_, "told": True, **draw(forms.about())}
    if draw(st.booleans()):
        part["default"] = draw(st.integers(0, greatest))
    if draw(forms.one_in(3)):
        part["once"] = True
    return part


def _is_alone(data: Data, placed: Placed) -> bool:
    """True if nobody else sends what these do, and no other form carries it."""
    messages = [item for item in data["messages"].values() if placed.carries(item)]
    others = [item for item in placed_frames(data) if item.holder is not placed.holder]
    return not any(
        other.carries(message) for other in others for message in messages if other.form
    ) and all(set(senders_of(message)) <= placed.senders for message in messages)


def _can_be_told(parts: Data) -> bool:
    """True if nothing is in the way: virtual parts, runs of parts, or an end that is a start."""
    listed = list(parts.values())
    ends = [part for part in (listed[0], listed[-1]) if "literal" in part]
    bits = sum(_bits(part) for part in listed if _tells(part))
    return not any("virtual" in part for part in listed) and len(ends) < 2 and bits <= _ROOM - 32


def _tells(part: Data) -> bool:
    inner = part.get("bits", {})
    return bool(part.get("id")) or any(
        isinstance(item, dict) and item.get("id") for item in inner.values()
    )


def _bits(part: Data) -> int:
    width = re.search(r"\d+$", part["type"])
    return int(width[0]) if width else 8 * part.get("size", 1)


def _identify(draw: st.DrawFn, data: Data, placed: Placed, name: str) -> None:
    """Give the messages their values; those of one identity have the same."""
    parts = placed.parts
    own = [key for key, part in parts.items() if part.get("id")]
    own += [
        key
        for part in parts.values()
        for key, item in part.get("bits", {}).items()
        if isinstance(item, dict) and item.get("id")
    ]
    values: dict[str, Any] = {}
    for message in data["messages"].values():
        if not placed.carries(message):
            continue
        known = message.get("id")
        value = values.setdefault(repr(known), draw(st.integers(0, 255)))
        if not own:
            message["id"] = value
        else:
            by_part = isinstance(known, dict) and known.keys() <= set(own)
            message["id"] = {**(known if by_part else {own[0]: known}), name: value}
