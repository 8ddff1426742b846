"""Parts that go into checksums and are not sent, put into a schema that was drawn."""

from __future__ import annotations

from typing import Any

from hypothesis import strategies as st

from schema_fuzzing import forms
from schema_fuzzing.names import PARTS, fresh
from schema_fuzzing.parts import Maker, PartType, characters

Data = dict[str, Any]


def add_virtual(draw: st.DrawFn, data: Data, byte_bits: int, orders: dict[str, str]) -> None:
    """Put virtual parts into some frames that have a checksum, and values into their messages.

    `orders` has the byte order of each sender.
    """
    frame = data["frame"]
    shared = "payload" in frame
    taken = {
        name
        for parts in ([frame] if shared else frame.values())
        for key, part in parts.items()
        for name in (key, *part.get("bits", ()))
    }
    for sender, written in ({"": frame} if shared else dict(frame)).items():
        parts = written
        sums = [name for name, part in parts.items() if "algorithm" in part]
        if not sums or not draw(forms.one_in(4)):
            continue
        found = set(orders.values()) if shared else {orders.get(sender)}
        order = found.pop() if len(found) == 1 else None
        for _ in range(draw(st.sampled_from([1, 1, 2]))):
            name = draw(fresh(PARTS, taken))
            taken.add(name)
            part, type_ = _part(draw, byte_bits, order)
            parts = _with(draw, parts, name, part, draw(st.sampled_from(sums)))
            _give(draw, data, "" if shared else sender, name, (part, type_))
        if shared:
            data["frame"] = parts
        else:
            frame[sender] = parts


def _part(draw: st.DrawFn, byte_bits: int, order: str | None) -> tuple[Data, PartType]:
    maker = Maker(draw, byte_bits, order)
    type_, keys = maker.text() if draw(forms.one_in(6)) else maker.type()
    keys = {**keys, "virtual": True, **draw(forms.about())}
    if draw(forms.one_in(3)):
        keys["default"] = draw(_value(type_))
    return keys, type_


def _value(type_: PartType) -> st.SearchStrategy[Any]:
    if type_.type == "ascii":
        return characters(type_.size, 0x20, 0x7E)
    return st.integers(0, type_.greatest)


def _with(draw: st.DrawFn, parts: Data, name: str, part: Data, checksum: str) -> Data:
    """The parts with a virtual one among them, which this checksum covers."""
    items = list(parts.items())
    last = len(items) - ("idle" in items[-1][1])  # Nothing stands behind a silence.
    items.insert(draw(st.integers(0, last)), (name, part))
    covers = parts[checksum]["covers"]
    listed = [covers] if isinstance(covers, str) else list(covers)
    return {**dict(items), checksum: {**parts[checksum], "covers": [*listed, name]}}


def _give(
    draw: st.DrawFn, data: Data, sender: str, name: str, drawn: tuple[Data, PartType]
) -> None:
    """Values for the messages of a sender, or of all; those of one identity have the same."""
    part, type_ = drawn
    values: dict[str, Any] = {}
    for message in data["messages"].values():
        senders = [message["from"]] if isinstance(message["from"], str) else message["from"]
        if sender and sender not in senders:
            continue
        key = repr(message.get("id"))
        if key not in values:
            is_left_out = "default" in part and draw(st.booleans())
            values[key] = None if is_left_out else draw(_value(type_))
        if values[key] is not None:
            message["parts"] = {**message.get("parts", {}), name: values[key]}
