"""Prints the pages."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import PurePosixPath

from protogen.model.protocol import Protocol
from protogen.targets.banner import MARKDOWN, banner
from protogen.targets.html.bench import page_script
from protogen.targets.html.plans import plans
from protogen.targets.html.reference import reference
from protogen.targets.html.search import entries
from protogen.targets.html.shell import data, printed
from protogen.targets.output import File


def emit(protocols: Sequence[Protocol]) -> tuple[File, ...]:
    """A page for each protocol, and an index of them."""
    if not protocols:
        return ()
    ordered = sorted(protocols, key=lambda protocol: protocol.name)
    pages = [
        File(PurePosixPath(f"{item.name}.html"), page_text(item), banner(MARKDOWN, [item]))
        for item in ordered
    ]
    text = printed("index", protocols=ordered)
    index = File(PurePosixPath("index.html"), text, banner(MARKDOWN, ordered), shared=True)
    return (*pages, index)


def page_text(protocol: Protocol) -> str:
    """A protocol's page without its banner; without a codec, it has the reference alone."""
    body, headings = reference(protocol)
    return printed(
        "page",
        page_script(protocol),
        protocol=protocol,
        body=body,
        headings=headings,
        plans=data(plans(protocol)),
        entries=data(entries(protocol)),
    )
