"""Names that generated code has in place of a schema's."""

from __future__ import annotations

from collections.abc import Iterator

from protogen.targets.emitted import ByLanguage, EmittedNames
from protogen.targets.markdown.text.table import Table, table
from protogen.targets.markdown.text.words import capital, code, listed
from protogen.targets.naming import Thing


def in_code(names: ByLanguage) -> str:
    """Return ``In C: `long_` ``, or nothing where code has the schema's name."""
    alike: dict[str, list[str]] = {}
    for language, spelled in names.items():
        alike.setdefault(listed([*map(code, spelled)]), []).append(language)
    texts = (f"in {listed(languages)}: {text}" for text, languages in alike.items())
    return capital("; ".join(texts))


def other_names(names: EmittedNames) -> Table | None:
    """Return the names that stand beside no field and no part; None if there are none."""
    rows = [*_rows(names)]
    return table(("Name", "In C", "In Python"), rows) if rows else None


def _rows(names: EmittedNames) -> Iterator[tuple[str, ...]]:
    for thing, by_language in names.escapes.items():
        left = {
            language: [name for name in spelled if name != _shown(thing)]
            for language, spelled in by_language.items()
        }
        cells = [", ".join(map(code, left.get(language, ()))) for language in ("C", "Python")]
        if any(cells):
            yield (thing.what, *cells)


def _shown(thing: Thing) -> str:
    """Return the escaped name that stands beside a field or part."""
    kind, *rest = thing.place
    is_field = kind == "records" and len(rest) == 3 and rest[1] == "fields"
    return f"{rest[-1]}_" if is_field or kind == "frame" else ""
