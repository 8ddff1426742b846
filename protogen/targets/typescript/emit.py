"""Prints a package: a module for each protocol, the runtime, and what describes them to npm."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from functools import cache
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
_RUNTIME = files(_PACKAGE) / "runtime"
_LAST_IMPORT = 'from "./shape.js";\n'
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
        calls = _calls(path.name.removeprefix(name))
        text = template.render(doc=module.doc(), declarations=declarations, calls=calls)
        yield File(path, text, first)


@cache
def _calls(ending: str) -> str:
    """What users call, which every module has alike: all behind the imports of its source."""
    folder = _RUNTIME if ending == ".ts" else _RUNTIME / "dist"
    text = (folder / "module" / f"calls{ending}").read_text(encoding="utf-8")
    behind = text.partition(_LAST_IMPORT)[2].strip("\n")
    return re.sub("\n+/\\*", "\n\n/*", behind)


def _runtime() -> Iterator[File]:
    """The runtime, as it was compiled when it was last changed."""
    for source, target in ((_RUNTIME, _SOURCES), (_RUNTIME / "dist", _BUILT)):
        for item in source.iterdir():
            if item.name.endswith((".ts", ".js")):
                path = target / "runtime" / item.name
                yield File(path, item.read_text(encoding="utf-8"), None, shared=True)
