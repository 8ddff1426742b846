"""Prints the pages."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import PurePosixPath

from protogen.model.protocol import Protocol
from protogen.targets.banner import MARKDOWN, banner
from protogen.targets.markdown.pages.overview import fidelity_view, index_view
from protogen.targets.markdown.pages.page import page_view
from protogen.targets.markdown.text.anchors import decision_link
from protogen.targets.output import File
from protogen.targets.printing import environment

_BLANK_LINES = re.compile(r"\n{3,}")
_ONE_BLANK_LINE = "\n\n"


def emit(protocols: Sequence[Protocol]) -> tuple[File, ...]:
    """Return a page for each protocol, an index and the page of counts, in order of name."""
    if not protocols:
        return ()
    ordered = sorted(protocols, key=lambda protocol: protocol.name)
    pages = [
        File(PurePosixPath(f"{item.name}.md"), page_text(item), banner(MARKDOWN, [item]))
        for item in ordered
    ]
    first_line = banner(MARKDOWN, ordered)
    views = {"index": index_view(ordered), "fidelity": fidelity_view(ordered)}
    shared = [
        File(PurePosixPath(f"{name}.md"), _render(name, view), first_line, shared=True)
        for name, view in views.items()
    ]
    return (*pages, *shared)


def page_text(protocol: Protocol) -> str:
    """Return a protocol's page without its banner.

    "decision NAME", as the texts of a schema refer to one, becomes a link.
    """
    text = _render("protocol", page_view(protocol))
    names = "|".join(decision.name for decision in protocol.decisions)
    if not names:
        return text
    # It begins with a plain word, as `re` looks for one much faster than for its edge.
    named = re.compile(rf"decision(?<=\bdecision) `?({names})\b`?")
    return named.sub(lambda found: f"decision {decision_link(found[1])}", text)


def _render(template: str, view: object) -> str:
    text = (
        environment("protogen.targets.markdown").get_template(f"{template}.md.j2").render(view=view)
    )
    return f"\n{_BLANK_LINES.sub(_ONE_BLANK_LINE, text).strip()}\n"
