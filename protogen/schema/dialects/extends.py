"""A schema with the schemas that it extends -> one tree.

A dialect names its base by `extends` and states only what is different. Bases may extend others.
The tree keeps the spans of the files that its nodes come from.
"""

from __future__ import annotations

import os
from pathlib import Path

import msgspec

from protogen.library import FOLDER, PREFIX, library_file, library_names
from protogen.problems import Problems, SourceMap, Span, hint_for
from protogen.schema.dialects.by_sender import spread_shared
from protogen.schema.dialects.merge import merge
from protogen.schema.dialects.project_folder import project_folder
from protogen.schema.dialects.provenance import name_documents
from protogen.schema.dialects.renames import apply_renames
from protogen.schema.dialects.short_forms import expand_short_forms
from protogen.schema.text.document import Document, decode_document, read_bytes, reason
from protogen.schema.text.nodes import Loc, MappingNode, Node, ScalarNode, find


class Merged(msgspec.Struct, frozen=True):
    """The tree of a schema and its bases. ``files`` are the schema's own, its base's, and so on."""

    root: Node
    files: tuple[str, ...]

    def find(self, loc: Loc, *, key: bool = False) -> Span:
        """Return the place that an error location means, in whichever file it is."""
        return find(self.root, loc, key=key)


def merge_bases(document: Document, problems: Problems, sources: SourceMap) -> Merged | None:
    """Return ``document`` merged over the schemas that it extends.

    Returns None if one of them can't be had, which is reported; problems in what the documents
    say of each other are reported and leave a tree to go on with.
    """
    chain = _chain(document, problems, sources)
    if chain is None:
        return None
    *dialects, original = chain
    root = _stated(original, over_base=False) if dialects else _without_extends(original.root)
    for dialect in reversed(dialects):
        stated = _stated(dialect, over_base=True)
        # A rename in one sender's frame needs that frame, so sharing ends first.
        base = apply_renames(spread_shared(root, stated), stated, problems)
        root = merge(expand_short_forms(base, stated), stated, problems)
    return Merged(root, tuple(link.file for link in chain))


def _stated(document: Document, *, over_base: bool) -> Node:
    """Return what one of several files states, each source with its document's name."""
    return name_documents(_without_extends(document.root), over_base=over_base)


def _chain(document: Document, problems: Problems, sources: SourceMap) -> list[Document] | None:
    """Return the document, its base, the base's base, and so on."""
    folder = project_folder(document.file)
    chain = [document]
    seen = {os.path.realpath(document.file)}
    while (written := chain[-1].root.child("extends")) is not None:
        named = _path(written, problems)
        if named is None:
            return None
        place = _locate(chain[-1].file, named, folder, problems)
        if place is None:
            return None
        if place in seen:
            files = ", ".join(f"`{link.file}`" for link in chain)
            problems.add("PG020", named.span, f"this closes a circle: {files}")
            return None
        base = _read_base(chain[-1].file, named, place, problems, sources)
        if base is None:
            return None
        seen.add(place)
        chain.append(base)
    return chain


def _path(named: Node, problems: Problems) -> ScalarNode | None:
    """Return what stands under `extends`, if it can be a path."""
    if isinstance(named, ScalarNode) and isinstance(named.value, str) and named.value:
        return named
    problems.add("PG025", named.span, "`extends` takes the path of one schema")
    return None


def _locate(file: str, named: ScalarNode, folder: Path, problems: Problems) -> str | None:
    """Return the real path of the base that ``file`` names, if it is in the project.

    Schemas of the library are in every project.
    """
    if named.text.startswith(PREFIX):
        return _in_library(named, problems)
    try:
        place = os.path.realpath(Path(file).parent / named.text)
    except ValueError as error:
        problems.add("PG022", named.span, f"the base can't be read: {error}")
        return None
    if not any(map(Path(place).is_relative_to, (folder, FOLDER))):
        hint = f"the project is the folder `{folder.name}`"
        problems.add("PG021", named.span, "the base is outside of the project", hint)
        return None
    return place


def _in_library(named: ScalarNode, problems: Problems) -> str | None:
    name = named.text.removeprefix(PREFIX)
    found = library_file(name)
    if found is None:
        names = library_names()
        hint = hint_for(name, names) or f"there are {', '.join(names)}"
        problems.add("PG022", named.span, f"the library has no schema `{name}`", hint)
        return None
    return str(found)


def _read_base(
    file: str, named: ScalarNode, place: str, problems: Problems, sources: SourceMap
) -> Document | None:
    try:
        if Path(place).is_fifo():  # Nobody may ever write to it.
            problems.add("PG022", named.span, "the base can't be read: it is a pipe")
            return None
        data = read_bytes(place)
    except OSError as error:
        problems.add("PG022", named.span, f"the base can't be read: {reason(error)}")
        return None
    is_path = not named.text.startswith(PREFIX)
    label = os.path.normpath(Path(file).parent / named.text) if is_path else place
    base = decode_document(data, label, problems, sources)
    if base is not None and not isinstance(base.root, MappingNode):
        problems.add("PG022", named.span, "the base is no schema: it holds no mapping")
        return None
    return base


def _without_extends(root: Node) -> Node:
    if not isinstance(root, MappingNode) or root.child("extends") is None:
        return root
    kept = (item for item in root.items if item[0].value != "extends")
    return MappingNode(tuple(kept), root.span)
