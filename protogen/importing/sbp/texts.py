"""Text of a definition -> `ascii` of a schema."""

from __future__ import annotations

from typing import Any

from protogen.importing.sbp.spec import FieldSpec

_ENDS = {
    None: "",
    "unterminated": "",
    "null_terminated": "With NUL at its end.",
    "multipart": "Texts, each with NUL at its end.",
    "sequence": "Texts, each with NUL at its end.",
    "double_null_terminated": "Texts, each with NUL at its end, and one more NUL behind the last.",
}


def text_data(field: FieldSpec, *, is_last: bool) -> dict[str, Any] | None:
    """Return what a schema says of a text; None if it can't say where the text ends."""
    if field.size is not None:
        return {"type": "ascii", "size": field.size}
    if ends_inside(field, is_last=is_last):
        return {"type": "ascii", "until": 0}
    return {"type": "ascii", "size": {"fill": True}} if is_last else None


def ends_inside(field: FieldSpec, *, is_last: bool) -> bool:
    """True if a NUL tells where a text ends; at the end of a message some senders leave it out."""
    return field.size is None and field.encoding == "null_terminated" and not is_last


def end_of_text(field: FieldSpec, *, is_last: bool) -> str:
    """Return what a reader should know of the end of a text."""
    is_said = field.size is not None or ends_inside(field, is_last=is_last)
    return "" if is_said else _ENDS.get(field.encoding, "")


def is_known_encoding(field: FieldSpec) -> bool:
    """True if it is known how a text is encoded."""
    return field.encoding in _ENDS
