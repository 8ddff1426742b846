"""Sizes and offsets of rows, as expressions of C and as the schema of a capture has them."""

from __future__ import annotations

from collections.abc import Iterator

from protogen.capture.layout import message_record
from protogen.capture.schema import (
    OF_MESSAGES,
    CaptureSchema,
    Choice,
    Column,
    Record,
    TableSchema,
)
from protogen.targets.c.spelling import Names


def layout_of(schema: CaptureSchema, names: Names) -> dict[str, int]:
    """Expressions of C, and their values."""
    return dict(_layout(schema, names))


def _layout(schema: CaptureSchema, names: Names) -> Iterator[tuple[str, int]]:
    rows = {
        **{str(number): table for number, table in enumerate(schema.messages.values())},
        "invalid": schema.invalid,
        "unknown": schema.unknown,
    }
    for name, table in rows.items():
        yield f"sizeof(struct protogen_row_{name})", table.row.size
    for name, table in rows.items():
        for path, position in _members(table, names):
            yield f"offsetof(struct protogen_row_{name}, {path})", position


def _members(table: TableSchema, names: Names) -> Iterator[tuple[str, int]]:
    for column in table.columns:
        if column.role == "part":
            yield f"part_{column.source}", column.position
        elif column.role not in OF_MESSAGES:
            yield column.source, column.position
    if table.message is None or not table.fields:
        return
    # The struct's members have the schema's names as C spells them, whatever columns are called.
    inner = message_record(table.message)
    base = table.fields[0].position - inner.columns[0].position
    for path, position in _inside(inner, names):
        yield f"message.{path}", base + position


def _inside(record: Record, names: Names) -> Iterator[tuple[str, int]]:
    for column in record.columns:
        yield from _within(column, names.member(column.name), column.position, names)


def _within(column: Column, path: str, position: int, names: Names) -> Iterator[tuple[str, int]]:
    yield path, position
    path += "[0]" * len(column.counts)
    if isinstance(column.shape, Record):
        for inner, place in _inside(column.shape, names):
            yield f"{path}.{inner}", position + place
    elif isinstance(column.shape, Choice):
        cases = [case for _, case in column.shape.cases]
        cases += [] if column.shape.rest is None else [column.shape.rest]
        for case in cases:
            for inner, place in _within(case, names.member(case.name), 0, names):
                yield f"{path}.{inner}", position + place
