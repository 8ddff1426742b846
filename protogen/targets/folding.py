"""Paragraphs in lines of some width, and such lines in comments."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence


def folded(paragraph: str, width: int, *, at_hyphens: bool = True) -> list[str]:
    """Return the lines of a paragraph, at least one; what has no space in it is not broken."""
    if len(paragraph) <= width and paragraph.isprintable():
        return [paragraph]  # As most are, and the wrapper takes its time.
    lines = textwrap.wrap(paragraph, width, break_long_words=False, break_on_hyphens=at_hyphens)
    return lines or [""]


def block_comment(
    paragraphs: Sequence[str], width: int, *, at_hyphens: bool = True
) -> tuple[str, ...]:
    """The lines of a documentation comment of C and its kin; the text is safe in one already."""
    if len(paragraphs) == 1 and len(paragraphs[0]) + len("/**  */") <= width:
        return (f"/** {paragraphs[0]} */",)
    lines = ["/**"]
    for number, text in enumerate(paragraphs):
        lines += [" *"] * (number > 0)
        lines += [f" * {line}".rstrip() for line in folded(text, width - 3, at_hyphens=at_hyphens)]
    return (*lines, " */")
