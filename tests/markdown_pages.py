"""Reads generated pages: their tables and diagrams."""

from __future__ import annotations

import re

from protogen.model.protocol import Protocol
from protogen.targets.markdown.emit import emit


def page(made: Protocol, name: str = "tiny.md") -> str:
    return {str(file.path): file.text for file in emit([made])}[name]


def tables(text: str) -> list[list[list[str]]]:
    """Every table of a page, as rows of cells, the header first."""
    found = re.findall(r"(?:^\|.*\n)+", text, re.MULTILINE)
    return [[_cells(line) for line in rows.splitlines()] for rows in found]


def _cells(line: str) -> list[str]:
    return [cell.strip() for cell in re.split(r"(?<!\\)\|", line)[1:-1]]


def table_of(made: Protocol, first: str, index: int = 0) -> list[dict[str, str]]:
    """The rows of the table, after `index` others, whose header starts with `first`."""
    chosen = [rows for rows in tables(page(made)) if rows[0][0] == first][index]
    header, _, *rows = chosen
    return [dict(zip(header, row, strict=True)) for row in rows]


def layout(made: Protocol) -> list[dict[str, str]]:
    """The table of the first message."""
    return table_of(made, "Frame byte", len(made.senders))


def places(made: Protocol) -> list[tuple[str, str, str]]:
    """Name, frame byte and payload byte of each row of the first message, without code marks."""
    columns = ("Name", "Frame byte", "Payload byte")
    return [
        (plain[0], plain[1], plain[2])
        for row in layout(made)
        if (plain := [row.get(column, "").replace("`", "") for column in columns])
    ]


def diagrams(text: str) -> list[list[str]]:
    found = re.findall(r"```mermaid\n(.*?)\n```", text, re.DOTALL)
    return [diagram.split("packet-beta\n")[1].splitlines() for diagram in found]


def example_rows(made: Protocol) -> list[tuple[str, ...]]:
    return [tuple(row.values()) for row in table_of(made, "Byte")]
