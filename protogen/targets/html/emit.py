"""Prints the pages."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from importlib.resources import files
from pathlib import PurePosixPath

from protogen.errors import UserError
from protogen.model.protocol import Protocol
from protogen.targets.banner import MARKDOWN, banner
from protogen.targets.html.plans import plans
from protogen.targets.html.reference import reference
from protogen.targets.html.script import bundled
from protogen.targets.html.search import entries
from protogen.targets.html.shell import PACKAGE, data, printed
from protogen.targets.output import File
from protogen.targets.typescript.emit import codecs

_BUILT = PurePosixPath("dist")


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
    """A protocol's page without its banner."""
    body, headings = reference(protocol)
    return printed(
        "page",
        _script(protocol),
        protocol=protocol,
        body=body,
        headings=headings,
        plans=data(plans(protocol)),
        entries=data(entries(protocol)),
    )


def _script(protocol: Protocol) -> str | None:
    """The bench and the codec of the protocol; None where the TypeScript target has no codec.

    Then there is the reference alone.
    """
    try:
        printed_codec = codecs([protocol])
    except UserError:
        return None
    modules = dict(_page_modules())
    codec = ""
    for file in printed_codec:
        if file.path.suffix == ".js" and file.path.is_relative_to(_BUILT):
            place = file.path.relative_to(_BUILT)
            modules[f"codec/{place}"] = file.text
            codec = str(place) if len(place.parts) == 1 else codec
    modules["codec.js"] = modules.pop(f"codec/{codec}").replace('"./runtime/', '"./codec/runtime/')
    return bundled(modules, "main.js", {"codec.js": ("protocol",)})


@cache
def _page_modules() -> tuple[tuple[str, str], ...]:
    folder = files(PACKAGE) / "page"
    return tuple(
        (item.name, item.read_text(encoding="utf-8"))
        for item in sorted(folder.iterdir(), key=lambda item: item.name)
        if item.name.endswith(".js")
    )
