"""Spelling of a single value: hex stays hex, and quotes stay where there were some."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator

from protogen.layout.nodes import Scalar

FOLDED = ">-"
_FOLDABLE = re.compile(r"[^\s](?:[^\n]*[^\s])?")


def on_one_line(scalar: Scalar, *, in_flow: bool) -> str:
    """Return the scalar as it is written on one line."""
    if scalar.style:
        return _with_quotes(scalar)
    if "\n" in scalar.value:
        return quoted(scalar.value)
    # A value that was left out can't be read again between brackets.
    return scalar.value or ("null" if in_flow else "")


def _with_quotes(scalar: Scalar) -> str:
    is_single_line = "\n" not in scalar.source
    if scalar.style == '"' and is_single_line:
        return scalar.source
    needs_escapes = '"' in scalar.value or "\\" in scalar.value
    if scalar.style == "'" and is_single_line and needs_escapes:
        return scalar.source
    return quoted(scalar.value)


def quoted(text: str) -> str:
    """Return the text between double quotes."""
    return '"' + "".join(map(_escaped, text)) + '"'


def _escaped(character: str) -> str:
    if character in '"\\' or ord(character) < 0x20:
        return json.dumps(character)[1:-1]
    if character.isprintable():
        return character
    code = ord(character)
    return f"\\u{code:04X}" if code < 0x10000 else f"\\U{code:08X}"


def can_be_folded(scalar: Scalar) -> bool:
    """Tell whether the text can be written as one paragraph below its key."""
    text = scalar.value
    return (
        "  " not in text
        and " " in text
        and text.isprintable()
        and _FOLDABLE.fullmatch(text) is not None
    )


def folded(text: str, width: int) -> list[str]:
    """Return the words of a text in lines of at most `width` characters, if words allow it."""
    return list(filled(text.split(" "), width))


def filled(words: list[str], width: int) -> Iterator[str]:
    """Yield lines of words with a space between them."""
    line = ""
    for word in words:
        if line and len(line) + 1 + len(word) > width:
            yield line
            line = word
        else:
            line = f"{line} {word}" if line else word
    if line:
        yield line


def block_lines(scalar: Scalar, width: int) -> tuple[str, list[str]] | None:
    """Return the header and the lines of a block, without indentation.

    None where a block could not say the same: then it is to be written between quotes.
    """
    header, *lines = scalar.source.split("\n")
    header = header.split("#")[0].strip()
    if not re.fullmatch(r"[|>]-?", header) or not any(line.strip() for line in lines):
        return None
    indent = next(len(line) - len(line.lstrip(" ")) for line in lines if line.strip())
    if any(line.strip() and not line.startswith(" " * indent) for line in lines):
        return None
    cut = [line[indent:] for line in lines]
    if header == FOLDED and can_be_folded(scalar) and max(map(len, cut)) > width:
        cut = folded(scalar.value, width)
    return header, cut
