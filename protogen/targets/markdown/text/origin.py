"""Docs and sources of things, as Markdown."""

from __future__ import annotations

import re

from protogen.model.origin import About, Source
from protogen.targets.escape import markdown, paragraphs
from protogen.targets.markdown.text.words import capital, sentence, sentences

_PLAIN_URL = re.compile(r"https?://[A-Za-z0-9./_~%?=&#:@+,;-]+")

_COMMIT = re.compile(r"\b[0-9a-f]{40}\b")
_DIGITS = 10
"""Digits of a commit that are shown beside a field; the page's top has all of them."""
_WORDS = ("line", "lines", "section", "revision")
"""First words of a source that names no document."""


def prose(text: str) -> tuple[str, ...]:
    """Return the paragraphs of a text."""
    return tuple(markdown(part) for part in paragraphs(text))


def place(source: Source | None) -> str:
    """Say where something is written down: document, section, lines, whichever are given."""
    if source is None:
        return ""
    revision = f"revision {_COMMIT.sub(_shortened, source.revision)}" if source.revision else ""
    texts = (source.document, revision, _section(source), _lines(source), source.note)
    plain = [markdown(text) for text in texts if text]
    return ", ".join([*plain, *([link(source.url)] if source.url else [])])


def link(url: str) -> str:
    """Print an address as a link if it is a plain one, else as text."""
    return f"<{url}>" if _PLAIN_URL.fullmatch(url) else markdown(url)


def about_line(about: About, *before: str) -> str:
    """Return the doc and the source in one line, behind other sentences."""
    source = place(about.source)
    text = sentences(*before, markdown(about.doc))
    if not text:
        return sentence(capital(source) if source.startswith(_WORDS) else source)
    return f"{text} ({source})" if source else text


def _shortened(commit: re.Match[str]) -> str:
    return commit[0][:_DIGITS]


def _section(source: Source) -> str:
    return f"section {source.section}" if source.section else ""


def _lines(source: Source) -> str:
    if not source.lines:
        return ""
    return f"line {source.lines}" if source.lines.isdigit() else f"lines {source.lines}"
