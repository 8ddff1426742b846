"""`protogen encode`: values -> bytes."""

from __future__ import annotations

import json
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping
from typing import TYPE_CHECKING, Annotated, Any, Literal

import typer

from protogen.cli.exits import CLEAN, UsageError
from protogen.cli.options import SchemaFile

if TYPE_CHECKING:
    from protogen.cli.wire.codec import Codec
    from protogen.model.frame import Frame
    from protogen.model.messages import Message

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
) -> int:
    """Make a frame from values, or bytes from lines of JSON.

    The lines are those of `protogen decode --format jsonl`; where one has `raw`, that is taken.
    """
    from protogen.cli.wire.codec import open_codec

    codec = open_codec(schema)
    write = _write_raw if format == "raw" else _write_hex
    if message is None:
        _encode_lines(codec, sender, write)
    else:
        write(_encode_message(codec, message, values or [], sender))
    return CLEAN


def _write_raw(data: bytes) -> None:
    sys.stdout.buffer.write(data)


def _write_hex(data: bytes) -> None:
    typer.echo(data.hex(" ").upper())


# --- one message ----------------------------------------------------------------------------------


def _encode_message(codec: Codec, name: str, written: Iterable[str], sender: str | None) -> bytes:
    from protogen.cli.schemas import find_message
    from protogen.cli.wire.hints import hint_at
    from protogen.cli.wire.values import raw_values, split_assignment, tree_of
    from protogen.runtime.codec import Encoder
    from protogen.runtime.errors import EncodeError

    message = find_message(codec.protocol, name)
    by = _sender_of(codec, message, sender)
    given = [split_assignment(text) for text in written]
    fields = raw_values(message.plan.steps, tree_of(item for item in given if item[0][0] != "@"))
    parts = _parts(codec.protocol.sender(by).frame, given)
    try:
        spec = codec.runtime.sender(by)
        kind = spec.named(name)
        assert kind is not None
        return Encoder(spec).encode_next(kind.from_dict(fields), strict=True, **parts)
    except EncodeError as error:
        raise UsageError(str(error), hint_at(message.plan.steps, fields, error.path)) from None


def _sender_of(codec: Codec, message: Message, name: str | None) -> str:
    from protogen.cli.schemas import find_sender

    if name is not None and find_sender(codec.protocol, name).name not in message.senders:
        raise UsageError(f"{name} does not send `{message.name}`; {_all_of(message.senders)} does")
    senders = [name] if name is not None else list(message.senders)
    frames = [codec.protocol.sender(item).frame for item in senders]
    if any(frame != frames[0] for frame in frames):
        text = f"`{message.name}` has several senders, and their frames differ"
        raise UsageError(text, f"give --sender {_all_of(senders)}")
    return senders[0]


def _all_of(names: Iterable[str]) -> str:
    return " or ".join(names)


def _parts(frame: Frame, given: Iterable[tuple[str, str]]) -> dict[str, int]:
    from protogen.problems import hint_for

    names = [part.name for part in frame.caller_parts]
    parts: dict[str, int] = {}
    for written, text in given:
        name = written.removeprefix("@")
        if name == written:
            continue
        if name not in names:
            hint = hint_for(name, names) or f"there are {', '.join(names) or 'none'}"
            raise UsageError(f"there is no part `{name}` to give", hint)
        parts[name] = _number(name, text)
    return parts


def _number(name: str, text: str) -> int:
    try:
        return int(text, 0)
    except ValueError:
        raise UsageError(f"@{name}: `{text}` is no number") from None


# --- lines of JSON --------------------------------------------------------------------------------


def _encode_lines(codec: Codec, sender: str | None, write: Write) -> None:
    from protogen.cli.schemas import find_sender
    from protogen.cli.wire.capture import STANDARD_INPUT, opened
    from protogen.convert.inputs.text_lines import lines_of

    if sender is not None:
        find_sender(codec.protocol, sender)
    if sys.stdin.isatty():
        raise UsageError("there is no message to encode", "name one, or pipe lines of JSON in")
    with opened(STANDARD_INPUT) as pieces:
        for number, line in _json_lines(lines_of(pieces)):
            if sender is None or line.setdefault("sender", sender) == sender:
                write(_encode_line(codec, number, line))


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
