"""Parts that are told, and not sent, put into a schema that was drawn."""

from __future__ import annotations

import re
from typing import Any

from hypothesis import strategies as st

from schema_fuzzing import forms
from schema_fuzzing.names import PARTS, fresh

Data = dict[str, Any]

_ROOM = 64
"""Bits that all identity parts have at most."""


def add_told(draw: st.DrawFn, data: Data) -> None:
    """Put a told part into the frame of all senders, or of one that shares no message."""
    if not draw(forms.one_in(6)):
        return
    frame = data["frame"]
    keys = [""] if "payload" in frame else [key for key in frame if _is_alone(data, key)]
    fitting = [key for key in keys if _can_be_told(frame[key] if key else frame)]
    if not fitting:
        return
    key = draw(st.sampled_from(fitting))
    parts = frame[key] if key else frame
    written = [frame] if not key else list(frame.values())
    taken = {name for item in written for name in item}
    taken |= {name for item in written for part in item.values() for name in part.get("bits", ())}
    name = draw(fresh(PARTS, taken))
    _identify(draw, data, key, parts, name)
    part = _telling(draw, draw(st.sampled_from(["uint8", "uint16", "uint32"])), 255)
    items = list(parts.items())
    last = len(items) - ("idle" in items[-1][1])  # Nothing stands behind a silence.
    items.insert(draw(st.integers(0, last)), (name, part))
    if key:
        frame[key] = dict(items)
    else:
        data["frame"] = dict(items)


def add_told_length(draw: st.DrawFn, data: Data) -> None:
    """Put a told length into some frames that have none, and that nothing is stuffed in."""
    frame = data["frame"]
    is_shared = "payload" in frame
    written = [frame] if is_shared else list(frame.values())
    taken = {name for parts in written for name in parts}
    taken |= {name for parts in written for part in parts.values() for name in part.get("bits", ())}
    for sender, parts in ({"": frame} if is_shared else dict(frame)).items():
        stuffed = data.get("transparency", {})
        if (stuffed and is_shared) or sender in stuffed or not _takes_a_length(parts):
            continue
        if draw(forms.one_in(2)):
            continue
        part = {**_telling(draw, "uint16", 3000), **draw(_counted(parts))}
        items = list(parts.items())
        items.insert(draw(st.integers(0, len(items))), (draw(fresh(PARTS, taken)), part))
        if is_shared:
            data["frame"] = dict(items)
        else:
            frame[sender] = dict(items)


def _takes_a_length(parts: Data) -> bool:
    """True if a length changes nothing about how frames start, and none is without bytes."""
    every = [*parts.values(), *(it for part in parts.values() for it in _bits_of(part))]
    if any("counts" in part or "idle" in part for part in every):
        return False
    first, *_, last = parts.values()
    if "literal" in first and "literal" in last and first["literal"] == last["literal"]:
        return False
    is_marked = "literal" in first or not any(key in first for key in ("range", "bits"))
    return is_marked and any(_is_always_there(part) for part in parts.values())


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


def _is_alone(data: Data, sender: str) -> bool:
    """True if nobody else sends what this one does."""
    senders = [message["from"] for message in data["messages"].values()]
    return all(item in (sender, [sender]) or sender not in item for item in senders)


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


def _identify(draw: st.DrawFn, data: Data, sender: str, parts: Data, name: str) -> None:
    """Give the messages their values; those of one identity have the same."""
    own = [key for key, part in parts.items() if part.get("id")]
    own += [
        key
        for part in parts.values()
        for key, item in part.get("bits", {}).items()
        if isinstance(item, dict) and item.get("id")
    ]
    values: dict[str, Any] = {}
    for message in data["messages"].values():
        if sender and message["from"] not in (sender, [sender]):
            continue
        known = message.get("id")
        value = values.setdefault(repr(known), draw(st.integers(0, 255)))
        if not own:
            message["id"] = value
        else:
            message["id"] = {**(known if isinstance(known, dict) else {own[0]: known}), name: value}
