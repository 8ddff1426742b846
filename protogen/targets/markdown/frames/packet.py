"""Diagrams of frames, in Mermaid's packet syntax.

One unit of the diagram is a byte, eight to a row. Mermaid's own numbers are switched off, as long
fields are drawn shorter than they are; each label begins with the byte's true position instead.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator

import msgspec

from protogen.model.frame import Frame
from protogen.model.messages import Message
from protogen.model.parts import LiteralPart, PayloadPart
from protogen.model.sizes import SizeSet
from protogen.targets.markdown.frames.layout import Slot, slots
from protogen.targets.markdown.text.words import hex_bytes, size_text, span

_ROW = 8
_NARROW = 2
"""Units that a cut block has at least, so that its label fits."""
_UNIT_WIDTH = 104
"""Pixels of a unit, and the characters that fit its label."""
_UNIT_CHARACTERS = 16

_HEAD = f"""\
---
config:
  packet:
    bitsPerRow: {_ROW}
    bitWidth: {_UNIT_WIDTH}
    showBits: false
---
packet-beta
"""
"""The older of the two names of this diagram: every version that has it knows this one."""


class Block(msgspec.Struct, frozen=True):
    """A box of the diagram."""

    place: str
    name: str
    size: int | None
    """Bytes; None where that varies."""

    def units(self, start: int) -> int:
        """Return the units to draw from `start` on: long blocks end with a row."""
        if self.size is not None and self.size <= _ROW:
            return self.size
        room = _ROW - start % _ROW
        return room if room >= _NARROW else room + _ROW


def frame_diagram(frame: Frame, payload: SizeSet) -> str:
    """Draw the parts of a frame."""
    return _diagram(_part_block(slot) for slot in slots(frame, payload))


def message_diagram(frame: Frame, message: Message) -> str | None:
    """Draw a message of fixed size in its frame, nothing left out; None if its size varies."""
    laid = slots(frame, message.sizes)
    if any(slot.sizes.fixed is None or slot.start is None for slot in laid):
        return None
    return _diagram(block for slot in laid for block in _blocks(slot, message))


def _blocks(slot: Slot, message: Message) -> Iterator[Block]:
    if not isinstance(slot.part, PayloadPart) or slot.start is None:
        yield _part_block(slot)
        return
    for field, start, size in slot.field_places(message.fields):
        yield Block(span(start, size), field.name, size)


def _part_block(slot: Slot) -> Block:
    fixed = slot.sizes.fixed
    place = "" if slot.start is None else slot.place
    size = None if fixed is None else fixed * slot.scale
    return Block(place, _part_label(slot, fixed is None), size)


def _part_label(slot: Slot, varies: bool) -> str:
    if varies:
        return f"{slot.part.name} ({size_text(slot.sizes)} bytes)"
    if isinstance(slot.part, LiteralPart):
        return f"{slot.part.name} {hex_bytes(slot.part.bytes)}"
    return slot.part.name


def _diagram(blocks: Iterable[Block]) -> str:
    lines, start = [], 0
    for block in blocks:
        units = block.units(start)
        if units:
            lines.append(f'{_range(start, units)}: "{_label(block, units)}"')
            start += units
    return _HEAD + "\n".join(lines)


def _range(start: int, units: int) -> str:
    return str(start) if units == 1 else f"{start}-{start + units - 1}"


def _label(block: Block, units: int) -> str:
    """Cut the label to what fits; names of a schema hold no character that Mermaid obeys."""
    text = f"{block.place} {block.name}".strip()
    room = min(units, _ROW) * _UNIT_CHARACTERS
    return text if len(text) <= room else f"{text[: room - 1]}…"
