"""Text from a schema, made safe for the languages that targets print.

Whatever the text holds, the result stays where it was put: in its table cell, paragraph, comment
or docstring. Characters that can't be seen (controls, bidirectional overrides) are written as
escapes, so that nobody reads other text than a compiler does.

In a protocol the same names and docs stand in many places, so that what was made of a text is kept
for a while.
"""

from __future__ import annotations

import re
from functools import lru_cache

_MARKED = re.compile(r"[\\`*\[\]|~$]")
"""Marks that Markdown obeys inside a line; each is safe behind a backslash."""
_UNDERSCORE = re.compile(r"(?<![A-Za-z0-9])_|_(?![A-Za-z0-9])")
"""Underscores at the edge of a word; inside `int_x` they mean nothing."""
_HASH = re.compile(r"(?:^|(?<= ))#")
"""A hash that could open a heading, or close one."""
_FIRST = re.compile(r"^([-+=](?=[-= ]|$)|\d+(?=[.)](?: |$)))")
"""Start of a line that would make a list, a rule or an underline at the start of a line."""
_CODE = re.compile(r"(?<!`)(`[A-Za-z0-9_.,:+/-]+`)(?!`)")
"""A name between backticks, as people write names in prose."""
_QUOTE = re.compile(r'"(?="|\Z)')
"""Quotes that could be part of the three that end a docstring."""
_OBEYED = re.compile(r"[\\`*\[\]|~$_#&<>]")
"""Characters of which at least one is in every text that Markdown could obey."""
_END_OF_COMMENT = re.compile(r"\*(?=/)|/(?=\*)")
_TAG = re.compile(r"[\\@{}<>]")
"""Marks that TSDoc obeys; each is plain behind a backslash."""
_TRIGRAPH = re.compile(r"\?(?=\?)")
_KEPT = 4096
"""Texts of which is remembered what was made of them, for each language."""
_BLANK_LINE = re.compile(r"\n[^\S\n]*\n\s*")


def visible(text: str) -> str:
    """Write each character that can't be seen as its escape; spaces stay."""
    if text.isprintable():
        return text
    return "".join(_shown(character) for character in text)


@lru_cache(_KEPT)
def one_line(text: str) -> str:
    """Put the text in one line, with single spaces between its words."""
    return visible(" ".join(text.split()))


@lru_cache(_KEPT)
def paragraphs(text: str) -> tuple[str, ...]:
    """Return the paragraphs of the text, each in one line; blank lines part them."""
    if text.isprintable():
        line = " ".join(text.split())
        return (line,) if line else ()
    lines = "\n".join(text.splitlines())
    return tuple(one_line(part) for part in _BLANK_LINE.split(lines) if part.strip())


@lru_cache(_KEPT)
def markdown(text: str) -> str:
    """Return a line that reads as the text in a paragraph, a heading or a table cell.

    A name between backticks is printed as code; nothing else of the text is markup.
    """
    if not text:
        return ""
    pieces = _CODE.split(one_line(text))
    pieces[::2] = map(_escaped, pieces[::2])
    return _FIRST.sub(_escaped_first, "".join(pieces))


def _escaped(text: str) -> str:
    if not _OBEYED.search(text):
        return text
    escaped = _MARKED.sub(r"\\\g<0>", text)
    escaped = escaped.replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;")
    return _HASH.sub(r"\#", _UNDERSCORE.sub(r"\_", escaped))


def html_comment(text: str) -> str:
    """Return one line for the inside of ``<!-- -->``."""
    return re.sub(r"-(?=-)", "- ", one_line(text)).replace(">", "&gt;")


def python_comment(text: str) -> str:
    """Return one line for behind a ``#``."""
    return one_line(text)


@lru_cache(_KEPT)
def python_docstring(text: str) -> str:
    """Return lines for the inside of triple double quotes, read back as the visible text."""
    lines = "\n".join(visible(line.expandtabs().rstrip()) for line in text.splitlines())
    return _QUOTE.sub(r"\"", lines.replace("\\", "\\\\"))


@lru_cache(_KEPT)
def c_comment(text: str) -> str:
    """Return one line for the inside of ``/* */`` or behind ``//``, however it is wrapped."""
    line = one_line(text).replace("\\", "&#92;")
    return _END_OF_COMMENT.sub(r"\g<0> ", _TRIGRAPH.sub("? ", line))


@lru_cache(_KEPT)
def tsdoc(text: str) -> str:
    """Return one line for the inside of ``/** */``, of which nothing is a tag or the end."""
    line = _END_OF_COMMENT.sub(r"\g<0> ", one_line(text))
    return _TAG.sub(r"\\\g<0>", line)


def _shown(character: str) -> str:
    if character.isprintable():
        return character
    return character.encode("unicode_escape").decode("ascii")


def _escaped_first(match: re.Match[str]) -> str:
    first = match[1]
    return f"{first}\\" if first.isdigit() else f"\\{first}"
