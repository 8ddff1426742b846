"""The sections of a protocol's page by their anchors, for use in other pages."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence

from protogen.model.protocol import Protocol
from protogen.targets.markdown.emit import page_text
from protogen.targets.markdown.text.anchors import message_anchor

_HEADING = re.compile(r'^(##|###) <a id="([^"]+)"></a>', re.MULTILINE)
_ANCHOR = re.compile(r'<a id="([^"]+)">')
_LINK = re.compile(r"\[([^\]\n]*)\]\(#([^)\s]+)\)")
_MESSAGES = "messages"


def sections(protocol: Protocol) -> Mapping[str, str]:
    """Return each section with its heading. That of the messages ends in front of the first one."""
    text = page_text(protocol)
    headings = list(_HEADING.finditer(text))
    return {
        heading[2]: text[heading.start() : _end(headings[index:], text)].strip()
        for index, heading in enumerate(headings)
    }


def _end(headings: Sequence[re.Match[str]], text: str) -> int:
    """Return where the first of some sections ends: at the next one that is no part of it."""
    first, *others = headings
    alone = first[1] == "###" or first[2] == _MESSAGES
    return next((item.start() for item in others if alone or item[1] == "##"), len(text))


def section_names(protocol: Protocol, texts: Mapping[str, str]) -> dict[str, str]:
    """Return what sections are called from outside, and their anchors.

    `rover.drive` is a message, `rover#frames` any other section by its anchor.
    """
    messages = {message_anchor(item.name): item.name for item in protocol.messages}
    return {
        f"{protocol.name}.{messages[anchor]}"
        if anchor in messages
        else f"{protocol.name}#{anchor}": anchor
        for anchor in texts
    }


def moved(text: str, page: str | None) -> str:
    """Return a section for another page: its links to the rest of its own page lead to `page`.

    Without such a page they become plain text.
    """
    own = set(_ANCHOR.findall(text))

    def link(found: re.Match[str]) -> str:
        if found[2] in own:
            return found[0]
        return found[1] if page is None else f"[{found[1]}]({page}#{found[2]})"

    return _LINK.sub(link, text)
