"""Prints a package: a module for each protocol, the runtime, and what describes them to npm."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from importlib.resources import files
from pathlib import PurePosixPath

from protogen.model.protocol import Protocol
from protogen.targets.banner import C, banner
from protogen.targets.output import File
from protogen.targets.printing import environment
from protogen.targets.typescript.module import Module
from protogen.targets.typescript.names import names_of
from protogen.targets.web_serial.emit import example
from protogen.version import VERSION

_PACKAGE = "protogen.targets.typescript"
_SOURCES, _BUILT = PurePosixPath("src"), PurePosixPath("dist")


def emit(protocols: Sequence[Protocol]) -> tuple[File, ...]:
    """The files of the package."""
    return (*codecs(protocols), *example(protocols)) if protocols else ()


def codecs(protocols: Sequence[Protocol]) -> tuple[File, ...]:
    """The package without its example."""
    names = sorted(names_of(protocol).file for protocol in protocols)
    text = (
        environment(_PACKAGE).get_template("package.json.j2").render(names=names, version=VERSION)
    )
    package = File(PurePosixPath("package.json"), text, None, shared=True)
    modules = (file for protocol in protocols for file in _module(protocol))
    return (package, *modules, *_runtime())


def _module(protocol: Protocol) -> Iterator[File]:
    module, first = Module(protocol), banner(C, [protocol])
    name, made = names_of(protocol).file, module.declarations()
    template = environment(_PACKAGE).get_template("module.j2")
    contents = {
        _SOURCES / f"{name}.ts": [item.typed for item in made],
        _BUILT / f"{name}.js": [item.plain for item in made if item.plain],
        _BUILT / f"{name}.d.ts": [item.types for item in made if item.types],
    }
    for path, declarations in contents.items():
        text = template.render(doc=module.doc(), declarations=declarations)
        yield File(path, text, first)


def _runtime() -> Iterator[File]:
    """The runtime, as it was compiled when it was last changed."""
    folder = files(_PACKAGE) / "runtime"
    for source, target in ((folder, _SOURCES), (folder / "dist", _BUILT)):
        for item in source.iterdir():
            if item.name.endswith((".ts", ".js")):
                path = target / "runtime" / item.name
                yield File(path, item.read_text(encoding="utf-8"), None, shared=True)
