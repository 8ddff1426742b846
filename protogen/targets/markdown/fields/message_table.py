"""The table of a message: everything in its frame, in wire order."""

from __future__ import annotations

from protogen.model.frame import Frame, PayloadPart
from protogen.model.messages import Message
from protogen.targets.markdown.fields.rows import Row, field_rows
from protogen.targets.markdown.fields.values import Anchors
from protogen.targets.markdown.frames.layout import Slot, part_title, slots
from protogen.targets.markdown.frames.parts import part_type, role, value_in
from protogen.targets.markdown.text.table import Table, table
from protogen.targets.markdown.text.words import size_text

_HEADER = ("Frame byte", "Payload byte", "Size", "Type", "Name", "Unit", "Range", "Meaning")


def message_table(frame: Frame, message: Message, anchors: Anchors) -> Table:
    """Return the table of everything in a message's frame, in wire order."""
    rows: list[tuple[str, ...]] = []
    for slot in slots(frame, message.sizes):
        if isinstance(slot.part, PayloadPart):
            rows += (_field_cells(row, slot) for row in field_rows(message.plan.steps, anchors))
        else:
            rows.append(_part_cells(slot, frame, message))
    return table(_HEADER, rows)


def _part_cells(slot: Slot, frame: Frame, message: Message) -> tuple[str, ...]:
    part = slot.part
    value = value_in(frame, part, message.identity, message.sizes)
    size = size_text(slot.sizes)
    return (slot.place, "", size, part_type(part), part_title(part), "", value, role(part))


def _field_cells(row: Row, payload: Slot) -> tuple[str, ...]:
    size = row.sizes.fixed
    in_frame = ""
    if payload.start is not None and not row.place.base:
        in_frame = row.place.text(size, payload.start, payload.scale)
    return (
        in_frame,
        row.place.text(size),
        size_text(row.sizes),
        row.type,
        row.name,
        row.unit,
        row.range,
        row.meaning,
    )
