"""A schema's text -> the same text in the canonical layout."""

from __future__ import annotations

from protogen.layout.order import put_in_order
from protogen.layout.printer import print_text
from protogen.layout.reading import read

_BYTE_ORDER_MARK = "\ufeff"


def format_text(text: str) -> str:
    """Return the text of a schema without problems in the canonical layout.

    Comments, names, numbers as they are written, and line breaks of the kind that the text has are
    kept.
    """
    unix = text.removeprefix(_BYTE_ORDER_MARK).replace("\r\n", "\n").replace("\r", "\n")
    read_text = read(unix)
    put_in_order(read_text.root)
    printed = print_text(read_text)
    return printed.replace("\n", "\r\n") if "\r\n" in text else printed
