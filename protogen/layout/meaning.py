"""The proof that a new layout says the same: data and models of both texts are compared."""

from __future__ import annotations

import os
from typing import Any

from protogen.compiler import compile_file
from protogen.copying import field_names
from protogen.problems import Problems, Span
from protogen.schema.text.document import parse_document
from protogen.schema.text.nodes import to_data


def same_meaning(path: str | os.PathLike[str], before: str, after: str) -> bool:
    """Tell whether both texts, each as the schema at `path`, hold the same and mean the same."""
    if not _agree(_data(before), _data(after)):
        return False
    old, new = (compile_file(path, text=text).protocol for text in (before, after))
    return _agree(old, new)


def _data(text: str) -> Any:
    document = parse_document(text, "", Problems())
    return None if document is None else to_data(document.root)


def _agree(one: Any, other: Any) -> bool:
    """Tell whether two pieces of data or of models are equal but for the places in the text.

    NaN equals NaN here, wherever it stands.
    """
    if type(one) is not type(other):
        return False
    if isinstance(one, Span):
        return True
    if isinstance(one, dict):
        return one.keys() == other.keys() and all(_agree(one[key], other[key]) for key in one)
    if isinstance(one, list | tuple):
        return len(one) == len(other) and all(map(_agree, one, other))
    names = field_names(type(one))
    if names:
        return all(_agree(getattr(one, name), getattr(other, name)) for name in names)
    return bool(one == other or (one != one and other != other))
