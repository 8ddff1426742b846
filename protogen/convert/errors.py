"""Errors that a user can fix."""

from __future__ import annotations

from importlib import import_module
from types import ModuleType

_EXTRAS = {
    "numpy": "capture",
    "pyarrow": "parquet",
    "mcap": "mcap",
    "zstandard": "capture",
    "fsspec": "dask",
    "dask": "dask",
    "distributed": "dask",
}
"""The extra that brings each package."""


class ConvertError(Exception):
    """A capture can't be converted; `hint` says what to do about it."""

    def __init__(self, message: str, hint: str | None = None) -> None:
        super().__init__(message)
        self.hint = hint

    def __reduce__(self) -> tuple[type[ConvertError], tuple[str, str | None]]:
        # It comes back from other processes as well.
        return type(self), (str(self), self.hint)


def needed(module: str, purpose: str) -> ModuleType:
    """Import a module of an extra. Raises ConvertError with the line that installs it."""
    package = module.partition(".")[0]
    try:
        return import_module(module)
    except ImportError as error:
        if not isinstance(error, ModuleNotFoundError):  # It is there, but does not fit the rest.
            raise ConvertError(f"{purpose} needs the package {package}: {error}") from None
        raise ConvertError(
            f"{purpose} needs the package {package}, which is not installed",
            f"pip install 'protogen-serial[{_EXTRAS[package]}]'",
        ) from None
