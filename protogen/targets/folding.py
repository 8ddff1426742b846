"""Paragraphs in lines of some width."""

from __future__ import annotations

import textwrap


def folded(paragraph: str, width: int, *, at_hyphens: bool = True) -> list[str]:
    """Return the lines of a paragraph, at least one; what has no space in it is not broken."""
    if len(paragraph) <= width and paragraph.isprintable():
        return [paragraph]  # As most are, and the wrapper takes its time.
    lines = textwrap.wrap(paragraph, width, break_long_words=False, break_on_hyphens=at_hyphens)
    return lines or [""]
