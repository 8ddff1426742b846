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
    from protogen.model.messages import Message
    from protogen.model.parts import NumberPart
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

    codec = open_codec(schema)
    write = _write_raw if format == "raw" else _write_hex
    if message is None:
        _encode_lines(codec, sender, write)
    else:
        write(encode_message(codec, message, values or [], sender, form))
    return CLEAN


def _write_raw(data: bytes) -> None:
    sys.stdout.buffer.write(data)


def _write_hex(data: bytes) -> None:
    typer.echo(data.hex(" ").upper())


# --- one message ----------------------------------------------------------------------------------


def encode_message(
    codec: Codec, name: str, written: Iterable[str], sender: str | None, form: str | None
) -> bytes:
    """Return the frame of a message with values as they are written. Raises UsageError."""
    from protogen.cli.schemas import find_message
    from protogen.cli.wire.hints import hint_at
    from protogen.cli.wire.values import raw_values, split_assignment, tree_of
    from protogen.model.messages import given_parts
    from protogen.runtime.attributes import arguments
    from protogen.runtime.codec import Encoder
    from protogen.runtime.errors import EncodeError

    message = find_message(codec.protocol, name)
    forms = _forms_of(codec, message, sender, form)
    given = [split_assignment(text) for text in written]
    fields = raw_values(message.plan.steps, tree_of(item for item in given if item[0][0] != "@"))
    parts = _parts([part for item in forms for part in given_parts(item.frame, message)], given)
    try:
        specs = [codec.runtime.sender(item.name) for item in forms]
        kind = specs[0].named(name)
        assert kind is not None
        record = kind.from_dict(fields)
        return Encoder(specs).encode_next(record, strict=True, **arguments(parts))
    except EncodeError as error:
        raise UsageError(str(error), hint_at(message.plan.steps, fields, error.path)) from None


def _forms_of(codec: Codec, message: Message, name: str | None, form: str | None) -> list[Sender]:
    """Return who sends the message, in each form of frame that is asked for and carries it."""
    from protogen.cli.schemas import check_known, find_senders

    found = codec.protocol.senders_of(message)
    if name is not None:
        found = tuple(item for item in find_senders(codec.protocol, name) if item.sends(message))
    if not found:
        raise UsageError(f"{name} does not send `{message.name}`; {_all_of(message.senders)} does")
    forms: dict[str, list[Sender]] = {}
    for item in found:
        forms.setdefault(item.endpoint, []).append(item)
    frames = [[item.frame for item in own] for own in forms.values()]
    if any(own != frames[0] for own in frames):
        text = f"`{message.name}` has several senders, and their frames differ"
        raise UsageError(text, f"give --sender {_all_of(forms)}")
    own = next(iter(forms.values()))
    if form is not None:
        known = [item.form for item in own if not item.is_only_form]
        check_known("form of frame", [form], known, codec.protocol.name)
    return [item for item in own if form in (None, item.form)]


def _all_of(names: Iterable[str]) -> str:
    return " or ".join(names)


def _parts(known: Iterable[NumberPart], given: Iterable[tuple[str, str]]) -> dict[str, int | str]:
    from protogen.cli.wire.scalars import text_value
    from protogen.problems import hint_for

    texts = {part.name: part.type.is_text for part in known}
    names = list(texts)
    parts: dict[str, int | str] = {}
    for written, text in given:
        name = written.removeprefix("@")
        if name == written:
            continue
        if name not in names:
            hint = hint_for(name, names) or f"there are {', '.join(names) or 'none'}"
            raise UsageError(f"there is no part `{name}` to give", hint)
        parts[name] = text_value(text, written) if texts[name] else _number(name, text)
    return parts


def _number(name: str, text: str) -> int:
    try:
        return int(text, 0)
    except ValueError:
        raise UsageError(f"@{name}: `{text}` is no number") from None


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
