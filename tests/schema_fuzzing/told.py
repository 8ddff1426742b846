"""Identities that are not sent, put into a schema that was drawn."""

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
    items = list(parts.items())
    last = len(items) - ("idle" in items[-1][1])  # Nothing stands behind a silence.
    items.insert(draw(st.integers(0, last)), (name, _part(draw)))
    if key:
        frame[key] = dict(items)
    else:
        data["frame"] = dict(items)


def _part(draw: st.DrawFn) -> Data:
    part: Data = {
        "type": draw(st.sampled_from(["uint8", "uint16", "uint32"])),
        "told": True,
        **draw(forms.about()),
    }
    if draw(st.booleans()):
        part["default"] = draw(st.integers(0, 255))
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
