"""`protogen explain`: an annotated dump of bytes."""

from __future__ import annotations

import sys
from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Annotated, Any

import typer

from protogen.cli.command import Command
from protogen.cli.exits import CLEAN
from protogen.cli.options import HexText, SchemaFile, SenderOfBytes, ToldParts
from protogen.convert.inputs.hex_digits import parse_hex
from protogen.copying import replace

if TYPE_CHECKING:
    from rich.console import Console

    from protogen.cli.console import Cell
    from protogen.model.protocol import Protocol, Sender
    from protogen.model.reading.annotate import Row

EXAMPLE = "Example: protogen explain schemas/matty.yaml --sender esp --hex 55020141BC"

_BYTES_IN_A_ROW = 8
_HEADS = ("offset", "wire", "unstuffed", "name", "type", "raw", "meaning")
_UNSTUFFED = _HEADS.index("unstuffed")


class ExplainCommand(Command):
    """The command, which says how bytes are given if they stand behind the schema."""

    allow_extra_args = True

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """Read the arguments. Raises BadParameter where there are too many."""
        super().parse_args(ctx, args)
        if ctx.args:
            problem = f"bytes are given as --hex '{' '.join(ctx.args)}'"
            raise typer.BadParameter(problem, ctx=ctx, param_hint="bytes behind the schema")
        return args


CLASS = ExplainCommand


def explain(
    schema: SchemaFile,
    sender: SenderOfBytes = None,
    hex: HexText = None,
    told: ToldParts = None,
    html: Annotated[
        bool, typer.Option("--html", help="Show it on the page of the schema, in a browser.")
    ] = False,
) -> int:
    """Show what each byte stands for.

    Each part and field has its bytes, type, raw value and meaning. Bytes that are no frame are
    taken apart as far as they look like one, with what is wrong.
    """
    from protogen.cli.console import console
    from protogen.cli.wire.codec import open_codec

    codec = open_codec(schema)
    data = parse_hex(_standard_input() if hex is None else hex)
    if html:
        from protogen.cli.opening import open_page

        open_page(codec.protocol, sender, data)
        return CLEAN
    decoder = codec.decoder(sender, told)
    out = console()
    if not data:
        out.print("no bytes")
    for event in (*decoder.feed(data), *decoder.flush()):
        _print_event(out, codec.protocol, event, decoder.told)
    return CLEAN


def _standard_input() -> str:
    return sys.stdin.buffer.read().decode("utf-8-sig", "replace")


def _print_event(out: Console, protocol: Protocol, event: Any, told: Mapping[str, int]) -> None:
    from protogen.cli.console import print_table

    out.print(*_title(event), style="bold red" if event.kind == "invalid" else "bold cyan")
    heads, rows = _columns(protocol, event, told)
    print_table(out, heads, rows)
    out.print()


def _title(event: Any) -> Iterator[str]:
    size = f"{event.size} byte{'' if event.size == 1 else 's'}"
    if event.sender:
        size = f"{size} from {event.sender}{f', {event.form}' if event.form else ''}"
    yield f"offset {event.offset}, {size}:"
    if event.kind == "message":
        yield f"message {event.message.NAME}"
    elif event.kind == "unknown":
        yield "a valid frame, but no message has its identity"
    else:
        yield f"no frame: {event.reason}{f', {event.problem}' if event.problem else ''}"


def _columns(
    protocol: Protocol, event: Any, told: Mapping[str, int]
) -> tuple[list[str], list[list[Cell]]]:
    """Return heads and rows, without a column for unstuffed bytes where nothing is stuffed."""
    sender = _sender(protocol, event)
    rows = [
        cells for row in _rows(protocol, sender, event, told) for cells in _lines(event.offset, row)
    ]
    if sender.frame.transparency is not None:
        return list(_HEADS), rows
    heads = [head for head in _HEADS if head != "unstuffed"]
    return heads, [[*cells[:_UNSTUFFED], *cells[_UNSTUFFED + 1 :]] for cells in rows]


def _sender(protocol: Protocol, event: Any) -> Sender:
    """Return the sender of an event; of bytes that are no frame, one whose frames begin so."""
    if event.kind != "invalid":
        return protocol.sender(event.sender, event.form)
    forms = protocol.forms(event.sender) if event.sender else protocol.senders
    begun = (item for item in forms if event.raw.startswith(item.plan.start_bytes))
    return next(begun, forms[0])


def _rows(protocol: Protocol, sender: Sender, event: Any, told: Mapping[str, int]) -> Sequence[Row]:
    from protogen.model.reading.annotate import Row, annotate

    if event.kind == "invalid" and event.reason == "noise":
        return [Row(offset=0, wire=event.raw, bytes=b"", path="", type="", meaning="noise")]
    numbers = told if event.kind == "invalid" else event.codec.layout.numbers_of(event.parts)
    rows = annotate(protocol, sender.name, event.raw, told=numbers)
    if event.kind == "invalid" and event.reason != "truncated":
        return [*rows[:-1], *map(_not_looked_at, rows[-1:])]
    return rows


def _not_looked_at(row: Row) -> Row:
    """Say of what is behind the byte that decided that nobody asked for it, not that it is missing.

    A decoder gives a frame up at that byte; those behind it begin something else.
    """
    if not row.cut or (row.wire and row.type == "literal"):
        return row
    text = "the rest was not looked at" if row.wire else "not looked at"
    return replace(row, fault="", meaning=text)


def _lines(offset: int, row: Row) -> Iterator[list[Cell]]:
    """Yield the cells of a row; many bytes take several lines."""
    from rich.text import Text

    meaning = Text(row.meaning)
    if row.fault:
        meaning.append(f"{' ' if row.meaning else ''}! {row.fault}", style="bold red")
    count = max(1, -(-max(len(row.wire), len(row.bytes)) // _BYTES_IN_A_ROW))
    for index in range(count):
        part = slice(index * _BYTES_IN_A_ROW, (index + 1) * _BYTES_IN_A_ROW)
        place = str(offset + row.offset + part.start)
        wire = row.bits or row.wire[part].hex(" ").upper()
        texts = (place, wire, row.bytes[part].hex(" ").upper())
        named = (row.path, row.type, _value(row.value), meaning) if index == 0 else ("", "", "", "")
        yield [*texts, *named]


def _value(value: int | float | str | None) -> str:
    from protogen.model.reading.readings import quoted

    if value is None:
        return ""
    return quoted(value) if isinstance(value, str) else str(value)
