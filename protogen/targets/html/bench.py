"""The scripts of pages: the modules of the bench, and codecs of the TypeScript target."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from importlib.resources import files
from pathlib import PurePosixPath

from protogen.errors import UserError
from protogen.model.protocol import Protocol
from protogen.targets.html.script import bundled
from protogen.targets.html.shell import PACKAGE
from protogen.targets.typescript.emit import codecs

_BUILT = PurePosixPath("dist")
_RUNTIME = "./runtime/"
_TAKEN = ("Decoder", "EncodeError", "encode", "protocol")
"""What the bench takes of a codec."""

Modules = dict[str, str]


def page_script(protocol: Protocol) -> str | None:
    """The bench of a protocol; None where the TypeScript target has no codec for it."""
    codec = _codec(protocol, "codec.js")
    if codec is None:
        return None
    return bundled(dict(_page_modules()) | codec, "main.js", {"codec.js": _TAKEN})


def has_codec(protocol: Protocol) -> bool:
    """True if a bench can decode what the protocol says."""
    return bool(protocol.senders) and _codec(protocol, "codec.js") is not None


def comparison_script(versions: Sequence[tuple[Protocol, Protocol]]) -> str:
    """The bench of pairs of versions, all of which have a codec."""
    modules, names = dict(_page_modules()), []
    for number, pair in enumerate(versions):
        for side, protocol in zip(("old", "new"), pair, strict=True):
            names.append(f"{side}{number}")
            modules |= _codec(protocol, f"{names[-1]}.js") or {}
    imports = "".join(f'import * as {name} from "./{name}.js";\n' for name in names)
    pairs = ", ".join(f"[old{number}, new{number}]" for number in range(len(versions)))
    modules["codecs.js"] = f"{imports}export const codecs = [{pairs}];\n"
    return bundled(modules, "comparison.js", {f"{name}.js": _TAKEN for name in names})


def _codec(protocol: Protocol, name: str) -> Modules | None:
    """The codec as a module of that name, and the runtime; None if there is no codec."""
    try:
        printed = codecs([protocol])
    except UserError:
        return None
    modules: Modules = {}
    for file in printed:
        if file.path.suffix == ".js" and file.path.is_relative_to(_BUILT):
            place = file.path.relative_to(_BUILT)
            modules[name if len(place.parts) == 1 else str(place)] = file.text
    return modules


@cache
def _page_modules() -> tuple[tuple[str, str], ...]:
    folder = files(PACKAGE) / "page"
    return tuple(
        (item.name, item.read_text(encoding="utf-8"))
        for item in sorted(folder.iterdir(), key=lambda item: item.name)
        if item.name.endswith(".js")
    )
