"""A schema file -> its syntax tree, with the schemas that it extends merged in."""

from __future__ import annotations

import os
import re
from typing import Any

import msgspec

from protogen.problems import Problems, SourceMap
from protogen.schema.dialects.extends import Merged, merge_bases
from protogen.schema.shape import Shape, read_shape
from protogen.schema.text.document import decode_document, read_document
from protogen.schema.text.nodes import MappingNode, to_data

_C = re.compile(r"^\s*(#include|#define|#ifndef|typedef|/\*|//|struct \w+ *\{)", re.MULTILINE)


class Loaded(msgspec.Struct, frozen=True):
    """A schema as it was written, and where each of its nodes stands."""

    shape: Shape
    data: Any
    """Data that the syntax tree was made of."""
    merged: Merged
    spoilt: bool
    """True if more than some examples could not be read."""


def load_syntax(
    path: str | os.PathLike[str],
    problems: Problems,
    sources: SourceMap,
    *,
    text: str | None = None,
) -> Loaded | None:
    """Read a schema, or `text` as if that stood in the file.

    Whatever is wrong is reported; None where that leaves nothing to work on.
    """
    if text is None:
        document = read_document(path, problems, sources)
    else:
        document = decode_document(text.encode("utf-8"), os.fspath(path), problems, sources)
    if document is None:
        return None
    merged = merge_bases(document, problems, sources)
    if merged is None:
        return None
    if not isinstance(merged.root, MappingNode):
        words = "a schema is a mapping, such as `protocol: name`"
        problems.add(
            "PG102", merged.root.span, words, _language_hint(sources.text(document.file) or "")
        )
        return None
    # Of two equal keys the first one counts; with that, the rest can still be looked at.
    sound = all(problem.code == "PG006" for problem in problems.errors)
    spoilt = bool(problems.errors)
    data = to_data(merged.root)
    shape = read_shape(data, merged.find, problems)
    if shape is None or not sound:
        return None
    return Loaded(shape, data, merged, spoilt or shape.spoilt)


def _language_hint(text: str) -> str | None:
    """Hint for a file that is written in another language."""
    if _C.search(text):
        return "this looks like C: protogen makes C from a schema, which is YAML"
    return None
