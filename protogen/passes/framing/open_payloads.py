"""Payloads that can hold a delimiter: which of their bytes can be it, and what keeps it out."""

from __future__ import annotations

from collections.abc import Sequence

from protogen.model.frame import Frame
from protogen.model.messages import Message
from protogen.passes.proofs.alphabets import fields_with
from protogen.passes.proofs.wire_code import SEVEN_BITS, ByteSet

_MOST_NAMED = 2


def open_payload(
    frame: Frame, values: ByteSet, messages: Sequence[Message], byte_bits: int
) -> tuple[str, str]:
    """Where payloads can have these bytes, and how a schema says that they don't, each in words.

    Both stand in a sentence about the delimiter, and may be empty.
    """
    if frame.payload.is_cut:
        return ", in what a newer sender may have behind the fields", ""
    fields = fields_with(messages, values, byte_bits)
    if fields:
        source = f", as {_listed(fields)} may have such bytes"
        whose = "such a field" if len(fields) > 1 else f"`{fields[0]}`"
    else:
        where = "a payload of an unknown identity" if frame.identity else "a payload"
        source = f", in {where}: no message has fields to go by"
        whose = ""
    return source, "" if values <= SEVEN_BITS or byte_bits == 7 else _below(whose, bool(fields))


def _below(whose: str, has_fields: bool) -> str:
    """What says that bytes have their highest bit clear."""
    whole = "if no payload byte has its highest bit set, say `byte_bits: 7`; otherwise "
    if not has_fields:
        return whole
    return (
        f"if {whose} never has them, give it a code, as in `{{type: uint7, code: {{bits: 7}}}}` (a "
        f"`range` keeps no byte out); {whole}"
    )


def _listed(names: Sequence[str]) -> str:
    shown = [f"`{name}`" for name in names[:_MOST_NAMED]]
    if len(names) > _MOST_NAMED:
        return f"{', '.join(shown)} and {len(names) - _MOST_NAMED} more"
    return " and ".join(shown)
