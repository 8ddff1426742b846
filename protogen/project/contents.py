"""Contents of marked blocks: sections of the reference pages of the schemas."""

from __future__ import annotations

import os
import re
from collections.abc import Sequence
from pathlib import Path

import msgspec

from protogen.model.protocol import Protocol
from protogen.problems import Problems, SourceMap, Span, hint_for
from protogen.project.blocks import Page, fill_page
from protogen.targets.markdown.pages.sections import moved, section_names, sections

_PROTOCOL = re.compile(r"[^.#]*")


class _Sections(msgspec.Struct, frozen=True):
    """The sections of all protocols by the names that blocks have for them."""

    protocols: dict[str, Protocol]
    problems: Problems
    made: dict[str, dict[str, str]] = msgspec.field(default_factory=dict)

    def find(self, name: str, place: Span) -> tuple[str, str] | None:
        """Return the protocol's name and the section; an unknown name is reported."""
        protocol = str(_PROTOCOL.match(name)[0])  # type: ignore[index]
        if protocol not in self.protocols:
            known = tuple(self.protocols)
            words = f"there is no protocol `{protocol}`; there are {', '.join(known)}"
            self.problems.add("PG034", place, words, hint_for(protocol, known))
            return None
        named = self._of(protocol)
        if name not in named:
            words = f"`{protocol}` has no section `{name}`"
            hint = hint_for(name, named) or f"there are {', '.join(named)}"
            self.problems.add("PG034", place, words, hint)
            return None
        return protocol, named[name]

    def _of(self, protocol: str) -> dict[str, str]:
        if protocol not in self.made:
            texts = sections(self.protocols[protocol])
            names = section_names(self.protocols[protocol], texts)
            self.made[protocol] = {name: texts[anchor] for name, anchor in names.items()}
        return self.made[protocol]


def fill_pages(
    paths: Sequence[Path],
    protocols: Sequence[Protocol],
    references: Path | None,
    problems: Problems,
    sources: SourceMap,
) -> list[Page]:
    """Return these files with their blocks filled.

    `references` is the folder of the generated pages, if there is one: links lead there.
    """
    known = _Sections({item.name: item for item in protocols}, problems)
    pages = (_fill(path, known, references, problems, sources) for path in paths)
    return [page for page in pages if page is not None]


def _fill(
    path: Path, known: _Sections, references: Path | None, problems: Problems, sources: SourceMap
) -> Page | None:
    def lookup(name: str, place: Span) -> str | None:
        found = known.find(name, place)
        return None if found is None else moved(found[1], _page_of(found[0], path, references))

    return fill_page(path, lookup, problems, sources)


def _page_of(protocol: str, path: Path, references: Path | None) -> str | None:
    """Return the link from a file to a generated page."""
    if references is None:
        return None
    return Path(os.path.relpath(references / f"{protocol}.md", path.parent)).as_posix()
