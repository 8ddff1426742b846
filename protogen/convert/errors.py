"""Errors that a user can fix."""

from __future__ import annotations

from importlib import import_module
from types import ModuleType

from protogen.errors import UserError

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


class ConvertError(UserError):
    """A capture can't be converted."""


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
