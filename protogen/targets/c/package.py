"""Files that make the output folder a package for CMake, PlatformIO, Arduino and Zephyr."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import PurePosixPath

from jinja2 import Environment

from protogen.model.protocol import Protocol
from protogen.targets.banner import PYTHON, banner
from protogen.targets.output import File
from protogen.version import VERSION

_SHARED = {
    "protogenConfig.cmake": "protogenConfig.cmake.j2",
    "CMakeLists.txt": "CMakeLists.txt.j2",
    "library.properties": "library.properties.j2",
    "zephyr/module.yml": "module.yml.j2",
    "zephyr/CMakeLists.txt": "zephyr.cmake.j2",
    "zephyr/Kconfig": "Kconfig.j2",
}
"""Files that take a comment behind `#`, and their templates."""


def package_files(
    protocols: Sequence[Protocol], files: Sequence[str], environment: Environment
) -> tuple[File, ...]:
    """The files around the codecs of these protocols, which are in `files`."""
    names = [protocol.name for protocol in protocols]
    given = {"files": dict(zip(names, files, strict=True)), "version": VERSION}
    first = banner(PYTHON, protocols)
    shared = [
        File(PurePosixPath(path), _render(environment, template, given), first, shared=True)
        for path, template in _SHARED.items()
    ]
    listed = _render(environment, "library.json.j2", given)
    return (*shared, File(PurePosixPath("library.json"), listed, None, shared=True))


def _render(environment: Environment, template: str, given: Mapping[str, object]) -> str:
    return environment.get_template(f"package/{template}").render(given)
