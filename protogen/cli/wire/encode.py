"""`protogen encode`: values -> bytes."""

from __future__ import annotations

import json
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Annotated, Any, Literal

import typer

from protogen.cli.exits import CLEAN, UsageError
from protogen.cli.options import SchemaFile

if TYPE_CHECKING:
    from protogen.cli.wire.codec import Codec
    from protogen.model.protocol import Sender

EXAMPLE = "Example: protogen encode schemas/matty.yaml go speed=500 steer=-2.5deg"

Assignments = Annotated[
    list[str] | None,
    typer.Argument(
        metavar="FIELD=VALUE|@PART=VALUE",
        help="Numbers (0x1F), names (ready|hot), values with a unit (90deg), bytes (hex:1B02),"
        " JSON for lists and structs.",
    ),
]

Write = Callable[[bytes], None]
"""Print the bytes of a frame or of another span."""


def encode(
    schema: SchemaFile,
    message: Annotated[
        str | None,
        typer.Argument(
            metavar="MESSAGE",
            help="The message; without it, lines of JSON come from standard input.",
        ),
    ] = None,
    values: Assignments = None,
    format: Annotated[
        Literal["hex", "raw"],
        typer.Option(help="Hex digits, one line for each frame, or the bytes."),
    ] = "hex",
    sender: Annotated[
        str | None,
        typer.Option(
            metavar="NAME",
            help="Who sends it, where several can; with lines of JSON, only this sender's lines.",
        ),
    ] = None,
    form: Annotated[
        str | None,
        typer.Option(
            metavar="NAME", help="The form of frame, where there are several. Default: that fits."
        ),
    ] = None,
) -> int:
    """Make a frame from values, or bytes from lines of JSON.

    The lines are those of `protogen decode --format jsonl`; where one has `raw`, that is taken.
    """
    from protogen.cli.wire.codec import open_codec
    from protogen.cli.wire.given import given_message

    codec = open_codec(schema)
    write = _write_raw if format == "raw" else _write_hex
    if message is None:
        _encode_lines(codec, sender, write)
    else:
        write(given_message(codec, message, values or [], sender, form).frame())
    return CLEAN


def _write_raw(data: bytes) -> None:
    sys.stdout.buffer.write(data)


def _write_hex(data: bytes) -> None:
    typer.echo(data.hex(" ").upper())


# --- lines of JSON --------------------------------------------------------------------------------


def _encode_lines(codec: Codec, sender: str | None, write: Write) -> None:
    from protogen.cli.schemas import find_senders
    from protogen.cli.wire.capture import STANDARD_INPUT, opened
    from protogen.convert.inputs.text_lines import lines_of

    chosen = None if sender is None else find_senders(codec.protocol, sender)
    if sys.stdin.isatty():
        raise UsageError("there is no message to encode", "name one, or pipe lines of JSON in")
    with opened(STANDARD_INPUT) as pieces:
        for number, line in _json_lines(lines_of(pieces)):
            if chosen is None or _is_from(chosen, line):
                write(_encode_line(codec, number, line))


def _is_from(senders: Sequence[Sender], line: dict[str, Any]) -> bool:
    """Return whether a line is from one of these; one that names no sender is from the first."""
    if line.setdefault("sender", senders[0].endpoint) != senders[0].endpoint:
        return False
    form = line.get("form")
    return form is None or any(form == item.form for item in senders)


def _json_lines(lines: Iterable[str]) -> Iterator[tuple[int, dict[str, Any]]]:
    from protogen.cli.wire.scalars import finite

    for number, text in enumerate(lines, start=1):
        if not text.strip():
            continue
        try:
            line = json.loads(text, parse_float=finite)
        except (ValueError, RecursionError) as error:
            raise UsageError(f"line {number}: not JSON: {error}") from None
        if not isinstance(line, dict):
            raise UsageError(f"line {number}: must be a JSON object")
        yield number, line


def _encode_line(codec: Codec, number: int, line: Mapping[str, Any]) -> bytes:
    from protogen.runtime.errors import EncodeError

    try:
        return codec.runtime.encode_line(line)
    except EncodeError as error:
        raise UsageError(f"line {number}: {error}") from None
