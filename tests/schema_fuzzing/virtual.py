"""Parts that go into checksums and are not sent, put into a schema that was drawn."""

from __future__ import annotations

from typing import Any

from hypothesis import strategies as st

from schema_fuzzing import forms
from schema_fuzzing.names import PARTS, fresh
from schema_fuzzing.parts import Maker, PartType, characters
from schema_fuzzing.placed import Data, Placed, names_of_parts, placed_frames


def add_virtual(draw: st.DrawFn, data: Data, byte_bits: int, orders: dict[str, str]) -> None:
    """Put virtual parts into some frames that have a checksum, and values into their messages.

    `orders` has the byte order of each sender.
    """
    taken = names_of_parts(data)
    for placed in placed_frames(data):
        sums = [name for name, part in placed.parts.items() if "algorithm" in part]
        if not sums or not draw(forms.one_in(4)):
            continue
        found = {orders.get(sender) for sender in placed.senders if sender in orders or not orders}
        order = found.pop() if len(found) == 1 else None
        for _ in range(draw(st.sampled_from([1, 1, 2]))):
            name = draw(fresh(PARTS, taken))
            taken.add(name)
            part, type_ = _part(draw, byte_bits, order)
            place = draw(st.integers(0, len(placed.parts)))
            parts = placed.with_part(place, name, part)
            placed.put(_covered(parts, draw(st.sampled_from(sums)), name))
            _give(draw, data, placed, name, (part, type_))


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


def _covered(parts: Data, checksum: str, name: str) -> Data:
    """The parts, of which this checksum covers one more."""
    covers = parts[checksum]["covers"]
    listed = [covers] if isinstance(covers, str) else list(covers)
    return {**parts, checksum: {**parts[checksum], "covers": [*listed, name]}}


def _give(
    draw: st.DrawFn, data: Data, placed: Placed, name: str, drawn: tuple[Data, PartType]
) -> None:
    """Values for the messages in such frames; those of one identity have the same."""
    part, type_ = drawn
    values: dict[str, Any] = {}
    for message in data["messages"].values():
        if not placed.carries(message):
            continue
        key = repr(message.get("id"))
        if key not in values:
            is_left_out = "default" in part and draw(st.booleans())
            values[key] = None if is_left_out else draw(_value(type_))
        if values[key] is not None:
            message["parts"] = {**message.get("parts", {}), name: values[key]}
