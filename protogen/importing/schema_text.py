"""Data of a schema -> its text, laid out as `protogen fmt` does it.

Data are mappings, lists, texts and numbers, in the order in which they are to stand. Between
brackets stands whatever has no paragraphs: the printer of `protogen fmt` makes blocks of what does
not fit its line.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from textwrap import wrap
from typing import Any

import msgspec

from protogen.layout.formatting import format_text
from protogen.layout.printer import STEP, WIDTH
from protogen.layout.scalars import quoted
from protogen.schema.text.scalars import SourceFloat, SourceInt, resolve

Data = Mapping[str, Any]

_PLAIN = re.compile(r"[A-Za-z0-9_.][A-Za-z0-9_./()%^*+;'-]*(?: [A-Za-z0-9_./()%^*+;'-]+)*")


class Number(msgspec.Struct, frozen=True):
    """Number in the spelling that it is to have, such as 0x0102 or 1/256; or a range of bits."""

    text: str


class Commented(msgspec.Struct, frozen=True):
    """Value whose key has a comment above it."""

    comment: str
    value: Any


def schema_text(root: Data, comment: str) -> str:
    """Return the text of a schema with a comment at its head."""
    lines = [*_comment(comment, 0), ""]
    for key, value in root.items():
        is_section = isinstance(value, Mapping) and key in ("types", "messages", "decisions")
        lines += [""] if is_section else []
        lines += _block(key, value, 0) if is_section else _item(key, value, 0)
    return format_text("\n".join(lines) + "\n")


def paragraphs(text: str) -> str:
    """Return a text with its paragraphs apart by an empty line, and no other line breaks.

    Characters that can't be printed are left out.
    """
    words = ([*map(_printable, part.split())] for part in re.split(r"\n\s*\n", text))
    return "\n\n".join(filter(None, (" ".join(filter(None, part)) for part in words)))


def joined(docs: Iterable[str]) -> str:
    """Return docs as one: as sentences, or as paragraphs where one of them has several."""
    found = list({doc.rstrip("."): doc for doc in docs if doc}.values())
    if any("\n" in doc for doc in found):
        return "\n\n".join(found)
    sentences = [doc if doc.endswith((".", "!", "?")) else f"{doc}." for doc in found[:-1]]
    return " ".join([*sentences, *found[-1:]])


def _printable(word: str) -> str:
    return "".join(filter(str.isprintable, word))


def _item(key: str, value: Any, indent: int) -> list[str]:
    if isinstance(value, Commented):
        return ["", *_comment(value.comment, indent), *_item(key, value.value, indent)]
    if isinstance(value, str) and "\n" in value:
        return [f"{' ' * indent}{_key(key)}: |-", *_literal(value, indent + STEP)]
    if isinstance(value, Mapping) and value and _has_lines(value):
        return _block(key, value, indent)
    return [f"{' ' * indent}{_key(key)}: {_inline(value)}"]


def _block(key: str, value: Data, indent: int) -> list[str]:
    inner = [line for name, item in value.items() for line in _item(name, item, indent + STEP)]
    return [f"{' ' * indent}{_key(key)}:", *inner]


def _has_lines(value: Any) -> bool:
    """True if something in a value takes several lines in any case."""
    if isinstance(value, Mapping):
        return any(map(_has_lines, value.values()))
    return isinstance(value, Commented) or (isinstance(value, str) and "\n" in value)


def _comment(text: str, indent: int) -> list[str]:
    width = WIDTH - indent - STEP
    lines = (line for part in text.split("\n") for line in wrap(part, width) or [""])
    return [f"{' ' * indent}# {line}".rstrip() for line in lines]


def _literal(text: str, indent: int) -> list[str]:
    """Return the lines of a text of several paragraphs, wrapped between words."""
    lines = (
        line
        for part in text.split("\n")
        for line in wrap(part, WIDTH - indent, break_long_words=False, break_on_hyphens=False)
        or [""]
    )
    return [" " * indent + line if line else "" for line in lines]


def _inline(value: Any) -> str:
    match value:
        case Number(text=text):
            return text
        case SourceInt() | SourceFloat():
            return value.text
        case bool():
            return "true" if value else "false"
        case int():
            return str(value)
        case str():
            return _text(value)
        case Mapping():
            return f"{{{', '.join(_entries(value))}}}"
        case Sequence():
            return f"[{', '.join(map(_inline, value))}]"
    raise TypeError(f"a schema holds no {type(value).__name__}")


def _entries(mapping: Data) -> Iterator[str]:
    for key, value in mapping.items():
        yield f"{_key(key)}: {_inline(value)}"


def _key(key: Any) -> str:
    return _text(key) if isinstance(key, str) else str(key)


def _text(text: str) -> str:
    """Return a text without quotes where it means the same without."""
    is_plain = _PLAIN.fullmatch(text) is not None and isinstance(resolve(text), str)
    return text if is_plain else quoted(text)
