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
    pages = [_page(protocol) for protocol in ordered]
    index = _file("index", ordered, view=index_view(ordered))
    fidelity = _file("fidelity", ordered, view=fidelity_view(ordered))
    return (*pages, index, fidelity)


def _page(protocol: Protocol) -> File:
    text = page_text(protocol)
    return File(PurePosixPath(f"{protocol.name}.md"), text, banner(MARKDOWN, [protocol]))


def page_text(protocol: Protocol) -> str:
    """Return a protocol's page without its banner."""
    return _linked(_render("protocol", view=page_view(protocol)), protocol)


def _linked(text: str, protocol: Protocol) -> str:
    """Turn "decision NAME", as the texts of a schema refer to one, into a link."""
    names = "|".join(decision.name for decision in protocol.decisions)
    return re.sub(rf"\bdecision `?({names})\b`?", _decision_link, text) if names else text


def _decision_link(match: re.Match[str]) -> str:
    return f"decision {decision_link(match[1])}"


def _file(name: str, protocols: Sequence[Protocol], view: object) -> File:
    return File(
        PurePosixPath(f"{name}.md"), _render(name, view), banner(MARKDOWN, protocols), shared=True
    )


def _render(template: str, view: object) -> str:
    text = (
        environment("protogen.targets.markdown").get_template(f"{template}.md.j2").render(view=view)
    )
    return f"\n{_BLANK_LINES.sub(_ONE_BLANK_LINE, text).strip()}\n"
