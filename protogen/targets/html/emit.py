"""Prints the pages."""

from __future__ import annotations

import json
from base64 import b64encode
from collections.abc import Sequence
from functools import cache
from hashlib import sha256
from importlib.resources import files
from pathlib import PurePosixPath
from typing import Any

from markupsafe import Markup

from protogen.model.protocol import Protocol
from protogen.targets.banner import MARKDOWN, banner
from protogen.targets.html.plans import plans
from protogen.targets.html.reference import reference
from protogen.targets.html.script import bundled
from protogen.targets.html.search import entries
from protogen.targets.output import File
from protogen.targets.printing import environment
from protogen.targets.typescript.emit import emit as emit_typescript

_PACKAGE = "protogen.targets.html"
_BUILT = PurePosixPath("dist")
_STYLES = ("page", "frames", "bench", "print")


def emit(protocols: Sequence[Protocol]) -> tuple[File, ...]:
    """A page for each protocol, and an index of them."""
    if not protocols:
        return ()
    ordered = sorted(protocols, key=lambda protocol: protocol.name)
    pages = [
        File(PurePosixPath(f"{item.name}.html"), page_text(item), banner(MARKDOWN, [item]))
        for item in ordered
    ]
    style = _style()
    shown = Markup(style)  # noqa: S704 - ours.
    policy = _policy(style, None)
    text = _template("index").render(protocols=ordered, style=shown, policy=policy)
    index = File(PurePosixPath("index.html"), text, banner(MARKDOWN, ordered), shared=True)
    return (*pages, index)


def page_text(protocol: Protocol) -> str:
    """A protocol's page without its banner."""
    body, headings = reference(protocol)
    style, script = _style(), _safe(_script(protocol))
    text: str = _template("page").render(
        protocol=protocol,
        body=body,
        headings=headings,
        style=Markup(style),  # noqa: S704 - ours.
        script=Markup(script),  # noqa: S704 - what could end it was taken out.
        plans=_data(plans(protocol)),
        entries=_data(entries(protocol)),
        policy=_policy(style, script),
    )
    return text


def _template(name: str) -> Any:
    return environment(_PACKAGE, autoescape=True).get_template(f"{name}.html.j2")


def _policy(style: str, script: str | None) -> str:
    """What the page may run and load: its own script and style, and nothing else."""
    run = "" if script is None else f" script-src {_hash(script)};"
    return f"default-src 'none';{run} style-src {_hash(style)}; base-uri 'none'; form-action 'none'"


def _hash(text: str) -> str:
    return f"'sha256-{b64encode(sha256(text.encode()).digest()).decode('ascii')}'"


def _data(value: object) -> Markup:
    """JSON for the inside of a script element, which no text in it ends."""
    text = json.dumps(value, ensure_ascii=True, separators=(",", ":"))
    return Markup(text.replace("<", "\\u003c"))  # noqa: S704 - made safe just here.


def _safe(script: str) -> str:
    """The script, of which no text ends its element; in a text, `<` is written as an escape."""
    return script.replace("</", "<\\/").replace("<!--", "<\\!--").replace("<script", "<\\script")


def _script(protocol: Protocol) -> str:
    """The bench, and the codec of the protocol."""
    modules = dict(_page_modules())
    codec = ""
    for file in emit_typescript([protocol]):
        if file.path.suffix == ".js" and file.path.is_relative_to(_BUILT):
            place = file.path.relative_to(_BUILT)
            modules[f"codec/{place}"] = file.text
            codec = str(place) if len(place.parts) == 1 else codec
    modules["codec.js"] = modules.pop(f"codec/{codec}").replace('"./runtime/', '"./codec/runtime/')
    return bundled(modules, "main.js", {"codec.js": ("protocol",)})


@cache
def _page_modules() -> tuple[tuple[str, str], ...]:
    folder = files(_PACKAGE) / "page"
    return tuple(
        (item.name, item.read_text(encoding="utf-8"))
        for item in sorted(folder.iterdir(), key=lambda item: item.name)
        if item.name.endswith(".js")
    )


@cache
def _style() -> str:
    folder = files(_PACKAGE) / "page"
    return "".join((folder / f"{name}.css").read_text(encoding="utf-8") for name in _STYLES)
