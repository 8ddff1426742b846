"""Calls of C's functions in the header for C++."""

from __future__ import annotations

from collections.abc import Mapping, Sequence


def call_of(function: str, parameters: Sequence[str], known: Mapping[str, str]) -> str:
    """The call of a function; `known` are arguments that are no names of its parameters."""
    names = (parameter.rpartition(" ")[2].lstrip("*") for parameter in parameters)
    return f"::{function}({', '.join(known.get(name, name) for name in names)})"
