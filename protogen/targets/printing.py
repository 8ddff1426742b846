"""Templates, found and printed in the same way for every target."""

from __future__ import annotations

from functools import cache

from jinja2 import (
    BytecodeCache,
    Environment,
    FileSystemBytecodeCache,
    PackageLoader,
    StrictUndefined,
)


@cache
def environment(package: str, *, autoescape: bool = False) -> Environment:
    """The templates of a target's package.

    Nothing is escaped, as views give text that is right for its language already; with
    `autoescape`, all but markup is, for HTML. Compiled templates are kept between runs where there
    is a place for it, because compiling them takes longer than printing.
    """
    return Environment(
        loader=PackageLoader(package),
        autoescape=autoescape,  # noqa: S701
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
        bytecode_cache=_kept(),
    )


def _kept() -> BytecodeCache | None:
    try:
        return FileSystemBytecodeCache(pattern="__protogen_%s.cache")
    except (OSError, RuntimeError):
        return None  # No folder that only this user can write to.
