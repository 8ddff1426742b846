"""Frames drawn to scale: a byte is as wide as another one, and so is a bit in the row of a byte.

Where something varies in size, or is longer than two rows, it is drawn shorter and says so.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator

import msgspec
from markupsafe import Markup

from protogen.model.meanings import BitField
from protogen.model.messages import Message
from protogen.model.parts import (
    BitsPart,
    FixedBits,
    LiteralPart,
    Part,
    PayloadPart,
    TypedPart,
    place_of,
    varying_bits,
)
from protogen.model.protocol import Protocol
from protogen.model.sizes import SizeSet
from protogen.model.types import Field
from protogen.targets.markdown.frames.layout import Slot, slots
from protogen.targets.markdown.frames.packet import message_diagram
from protogen.targets.markdown.frames.parts import role
from protogen.targets.markdown.pages.context import by_frame
from protogen.targets.markdown.pages.listing import ordered
from protogen.targets.markdown.text.words import hex_bytes, size_text

_ROW = 16
"""Bytes of a row."""
_BYTE = 44
"""Width of a byte."""
_HEIGHT = 34
_GAP = 16
"""Space above a row, for the numbers of bytes."""
_LONGEST = 2 * _ROW
"""Bytes of the longest block that is drawn whole."""
_SHORTENED = 6
"""Bytes that are drawn of what varies, or is longer."""
_LITERAL, _PART, _FIELD, _UNUSED = "l", "p", "f", "u"
"""Classes of boxes, of which a page has hundreds."""
_CHARACTER = 6.7
"""Width of a character of a label."""


class Run(msgspec.Struct, frozen=True):
    """Some bits of a block."""

    name: str
    low: int
    size: int


class Block(msgspec.Struct, frozen=True, kw_only=True):
    """Bytes of a frame."""

    name: str
    sizes: SizeSet
    kind: str
    """Class of its colour; the label says the same in words."""
    start: int | None
    """Byte of the frame; None where that varies."""
    note: str = ""
    runs: tuple[Run, ...] = ()
    """The bits of it that have names."""

    @property
    def is_whole(self) -> bool:
        """True if it is drawn as long as it is."""
        return self.sizes.fixed is not None and self.sizes.greatest <= _LONGEST

    @property
    def drawn(self) -> int:
        """Bytes that are drawn."""
        return self.sizes.greatest if self.is_whole else _SHORTENED

    @property
    def label(self) -> str:
        """What it is, in full."""
        size = f"{size_text(self.sizes)} byte{'' if self.sizes.fixed == 1 else 's'}"
        return f"{self.name}: {size}{f', {self.note}' if self.note else ''}"


def drawings(protocol: Protocol) -> Iterator[Markup]:
    """A drawing in place of each diagram of the Markdown page, in its order."""
    for senders in by_frame(protocol.senders):
        payload = senders[0].framing.payload
        for sender in senders[1:]:
            payload |= sender.framing.payload
        blocks = [_part(slot) for slot in slots(senders[0].frame, payload)]
        yield _drawing(blocks, f"Frame of {', '.join(item.name for item in senders)}")
    for message in ordered(protocol):
        for senders in by_frame(protocol.senders_of(message)):
            frame = senders[0].frame
            if message_diagram(frame, message) is not None:
                laid = slots(frame, message.sizes)
                blocks = [block for slot in laid for block in _message_blocks(slot, message)]
                yield _drawing(blocks, f"Frame of {message.name}")


def _message_blocks(slot: Slot, message: Message) -> Iterator[Block]:
    if not isinstance(slot.part, PayloadPart) or slot.start is None:
        yield _part(slot)
        return
    for field, start, size in slot.field_places(message.fields):
        yield Block(
            name=field.name,
            sizes=SizeSet.exactly(size),
            kind=_FIELD,
            start=start,
            note=field.type.label,
            runs=tuple(_field_runs(field)) if slot.scale == 1 else (),
        )


def _part(slot: Slot) -> Block:
    part = slot.part
    return Block(
        name=part.name,
        sizes=slot.sizes.times(SizeSet.exactly(slot.scale)),
        kind=_kind(part),
        start=slot.start,
        note=_note(part),
        runs=tuple(_part_runs(part)) if slot.scale == 1 else (),
    )


def _kind(part: Part) -> str:
    if isinstance(part, LiteralPart):
        return _LITERAL
    return _FIELD if isinstance(part, PayloadPart) else _PART


def _note(part: Part) -> str:
    if isinstance(part, LiteralPart):
        return hex_bytes(part.bytes)
    return role(part).rstrip(".").lower()


def _part_runs(part: Part) -> Iterator[Run]:
    if not isinstance(part, BitsPart) or part.whole is not None:
        return
    named: tuple[TypedPart | FixedBits, ...] = (*varying_bits(part), *part.constants)
    for item in named:
        yield Run(item.name, place_of(item.type), item.type.bits)


def _field_runs(field: Field) -> Iterator[Run]:
    integer = field.integer
    if integer is None or integer is not field.type:
        return
    for item in integer.bit_fields:
        yield from _runs_of(item)
    if integer.flags is not None:
        for flag in integer.flags.bits:
            yield Run(flag.name, flag.bit, 1)


def _runs_of(item: BitField) -> Iterator[Run]:
    for low, high in item.runs:
        yield Run(item.name, low, high - low + 1)


# --- SVG ------------------------------------------------------------------------------------------


def _drawing(blocks: Iterable[Block], title: str) -> Markup:
    drawn = [block for block in blocks if block.sizes.greatest]
    rows: list[list[Markup]] = []
    start = 0
    for block in drawn:
        for row, shape in _boxes(block, start):
            rows += [[] for _ in range(row + 1 - len(rows))]
            rows[row].append(shape)
        start += block.drawn
    rows += [[*_bits(block)] for block in drawn if block.runs]
    has_runs = any(block.runs for block in drawn)
    width = _BYTE * (_ROW if has_runs else min(start, _ROW)) + 2
    return Markup(
        '<figure class="frame"><div class="wide" tabindex="0">'
        '<svg role="img" width="{w}" height="{h}" viewBox="-1 0 {w} {h}" aria-label="{title}">'
        "{shapes}</svg></div></figure>\n"
    ).format(
        w=width,
        h=len(rows) * (_HEIGHT + _GAP) + 4,
        shapes=Markup("").join(map(_row, range(len(rows)), rows)),
        title=title,
    )


def _row(index: int, shapes: Iterable[Markup]) -> Markup:
    y = index * (_HEIGHT + _GAP) + _GAP
    return Markup('<g transform="translate(0 {})">{}</g>').format(y, Markup("").join(shapes))


def _boxes(block: Block, start: int) -> Iterator[tuple[int, Markup]]:
    """A box for each row that the block has bytes in, with the row."""
    left, first = block.drawn, True
    while left:
        column, row = start % _ROW, start // _ROW
        units = min(left, _ROW - column)
        x, width = column * _BYTE, units * _BYTE
        label = block.name if first else ""
        yield row, _box(block.label, block.kind, x, width, label, is_whole=block.is_whole)
        if first and block.start is not None:
            yield row, _number(x + 2, str(block.start))
        if block.is_whole and units > 1:
            ticks = "".join(f"M{x + tick * _BYTE} 0v5" for tick in range(1, units))
            yield row, Markup('<path d="{}"/>').format(ticks)
        start, left, first = start + units, left - units, False


def _bits(block: Block) -> Iterator[Markup]:
    """The bits of a block, the most significant one on the left, as wide as the drawing."""
    bits = 8 * block.sizes.greatest
    width = _ROW * _BYTE / bits
    named = {bit for run in block.runs for bit in range(run.low, run.low + run.size)}
    unnamed = (Run("", bit, 1) for bit in range(bits) if bit not in named)
    yield _number(2, f"bits of {block.name}, {bits - 1} to 0")
    for run in (*block.runs, *unnamed):
        x = (bits - run.low - run.size) * width
        last = run.low + run.size - 1
        place = f"bit {last}" if run.size == 1 else f"bits {run.low}..{last}"
        kind = _FIELD if run.name else _UNUSED
        label = f"{run.name or 'no name'}: {place} of {block.name}"
        yield _box(label, kind, x, run.size * width, run.name, is_whole=True)


def _box(title: str, kind: str, x: float, width: float, label: str, *, is_whole: bool) -> Markup:
    shown = _cut(label, width)
    text = Markup('<text x="{:g}">{}</text>').format(x + width / 2, shown) if shown else ""
    dash = "" if is_whole else Markup(' stroke-dasharray="4 3"')
    return Markup('<g class="{}"><title>{}</title><rect x="{:g}" width="{:g}"{}/>{}</g>').format(
        kind, title, x, width, dash, text
    )


def _number(x: float, text: str) -> Markup:
    return Markup('<text class="n" x="{:g}" y="-4">{}</text>').format(x, text)


def _cut(label: str, width: float) -> str:
    room = int((width - 2) / _CHARACTER)
    if len(label) <= room:
        return label
    return f"{label[: room - 1]}…" if room > 1 else ""
