"""`protogen decode`: bytes -> events."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

import typer

from protogen.cli.exits import CLEAN, FINDINGS, UsageError
from protogen.cli.options import CaptureFile, HexText, SchemaFile, SenderOfBytes, ToldParts
from protogen.cli.schemas import find_senders
from protogen.cli.wire.capture import (
    STANDARD_INPUT,
    InputFormat,
    begun,
    hex_pieces,
    opened,
    raw_pieces,
    recorded_pieces,
    timed_pieces,
)
from protogen.cli.wire.complaints import Complaints
from protogen.cli.wire.line_times import LineTimes
from protogen.cli.wire.silences import Silences
from protogen.cli.wire.tagged import Complain, Piece, tagged_pieces
from protogen.convert.inputs.hex_digits import parse_hex
from protogen.recording.reader import is_recording

if TYPE_CHECKING:
    from protogen.cli.wire.codec import Codec
EXAMPLE = "Example: protogen decode schemas/matty.yaml --sender esp --hex 55020141BC"

Tagged = Annotated[
    bool,
    typer.Option(
        "--tagged",
        help="The same as --input tagged: a log of both ways, with lines such as `pc: 1B 02`,"
        " `[pc] 1B 02`, `pc> 1B 02` or `12:00:01.5 pc: 1B 02`.",
    ),
]

Timed = Annotated[
    bool,
    typer.Option(
        "--timed",
        help="A silence ends what a decoder holds, of the schema's `idle` or link.idle_timeout: for"
        " logs with a time in front of each line, --input log or --tagged.",
    ),
]

EventFormat = Literal["text", "jsonl"]
Show = Callable[[Any], None]
"""Print an event."""


def decode(  # noqa: PLR0913 - each option is one argument
    schema: SchemaFile,
    file: CaptureFile = STANDARD_INPUT,
    sender: SenderOfBytes = None,
    hex: HexText = None,
    input: Annotated[
        InputFormat | None,
        typer.Option(
            "--input", help="What the file is written in. Default: raw, or record where it is one."
        ),
    ] = None,
    tagged: Tagged = False,
    timed: Timed = False,
    format: Annotated[
        EventFormat, typer.Option(help="One readable line for each event, or one of JSON.")
    ] = "text",
    strict: Annotated[
        bool, typer.Option("--strict", help="Exit with 1 if any byte belongs to no valid frame.")
    ] = False,
    told: ToldParts = None,
) -> int:
    """Cut bytes into messages, unknown frames and what is no frame.

    The bytes of all these events, joined, are the capture. Lines of JSON go back through
    `protogen encode`. Exits with 1 if a line of a tagged log can't be used, as its bytes are lost.
    """
    from protogen.cli.wire.codec import open_codec

    kind = _input_format(input, tagged=tagged, has_text=hex is not None)
    _check_timed(kind, timed=timed, has_text=hex is not None)
    codec = open_codec(schema)
    silences = Silences(codec.protocol) if timed else None
    if sender is not None:
        find_senders(codec.protocol, sender)
    complaints = Complaints()
    has_invalid = is_untold = False
    show = _printer(codec, format, show_sender=sender is None and len(codec.senders) > 1)
    with _capture(file, hex, kind, codec, sender, complaints.add, timed=timed) as pieces:
        for events in _batches(codec, sender, pieces, silences, told or ()):
            for event in events:
                has_invalid = has_invalid or event.kind == "invalid"
                is_untold = is_untold or event.kind != "message"
                show(event)
            sys.stdout.flush()
    complaints.report()
    if has_invalid and not timed:
        _hint_at_silences(codec)
    if is_untold and not told:
        _hint_at_told(codec)
    return FINDINGS if complaints.count or (strict and has_invalid) else CLEAN


def _hint_at_silences(codec: Codec) -> None:
    """Say what may be wrong where frames end by silences, and none was told of."""
    if ended := codec.protocol.frame_silences:
        text = f"only a silence ends a frame of {', '.join(ended)}; --timed takes it from a log"
        typer.echo(f"hint: {text} with times", err=True)


def _hint_at_told(codec: Codec) -> None:
    """Say what may be missing where frames do not say what they are, and nothing was told."""
    if codec.protocol.is_told:
        name = codec.protocol.told[0]
        what = "how long" if codec.protocol.is_told_length(name) else "what"
        text = f"some frames do not say {what} they are: give --told {name}=NUMBER"
        typer.echo(f"hint: {text}, or a log of both ways (--tagged)", err=True)


# --- in -------------------------------------------------------------------------------------------


def _input_format(given: InputFormat | None, *, tagged: bool, has_text: bool) -> InputFormat | None:
    """Return what the capture is written in; None if its first bytes have to tell.

    Raises UsageError where two options disagree.
    """
    if tagged and given not in (None, "raw", "tagged"):
        problem = f"--tagged and --input {given} exclude each other"
        raise UsageError(problem, "leave one of them out")
    if has_text and (tagged or given == "tagged"):
        hint = "leave out --tagged and give --sender NAME, or give the lines in a file"
        raise UsageError("--hex is bytes of one sender, --tagged is for lines that name it", hint)
    if has_text and given in ("log", "record"):
        problem = f"--hex is bytes, --input {given} is for files with times"
        raise UsageError(problem, "leave one out")
    return "tagged" if tagged else given


def _check_timed(kind: InputFormat | None, *, timed: bool, has_text: bool) -> None:
    """Raises UsageError where --timed is given for bytes without times."""
    if timed and (has_text or kind in ("raw", "hex")):
        hint = "give a recording, or --tagged or --input log, with a time in front of each line"
        raise UsageError("--timed needs to know when the bytes were sent", hint)


@contextmanager
def _capture(
    file: Path,
    text: str | None,
    kind: InputFormat | None,
    codec: Codec,
    sender: str | None,
    complain: Complain,
    *,
    timed: bool,
) -> Iterator[Iterable[Piece]]:
    """Open what is to be decoded. It is from `sender`, unless its lines are tagged."""
    by = sender or ""
    if text is not None and file != STANDARD_INPUT:
        raise UsageError(f"there are two captures: {file} and --hex")
    if text is not None:
        yield [Piece(by, parse_hex(text))]
        return
    with opened(file) as stream:
        head, pieces = begun(stream)
        match kind or ("record" if is_recording(head) else "raw"):
            case "raw":
                _check_timed("raw", timed=timed, has_text=False)
                yield raw_pieces(pieces, by)
            case "record":
                yield recorded_pieces(pieces, by, codec.senders, complain)
            case "hex":
                yield hex_pieces(pieces, by)
            case "tagged":
                times = LineTimes() if timed else None
                yield tagged_pieces(pieces, codec.senders, complain, times)
            case "log":
                yield timed_pieces(pieces, by, codec.senders, complain)


def _batches(
    codec: Codec,
    sender: str | None,
    pieces: Iterable[Piece],
    silences: Silences | None,
    told: Sequence[str],
) -> Iterator[list[Any]]:
    """Yield the events of each piece: from one sender, or from all, each with its decoder.

    A piece that names no sender may be from any. A silence in front of it ends what came before.
    What one sender's frames tell of another's, the decoder of that one hears.
    """
    from protogen.link.line import LineDecoders

    senders = codec.senders if sender is None else (sender,)
    line = LineDecoders(
        codec.runtime,
        senders,
        new=lambda source: codec.decoder(source or None, _told_to(codec, source, told)),
    )
    for piece in pieces:
        events = []
        for name in silences.passed(piece) if silences is not None else ():
            events += line.idle(name)
        yield events + line.feed(piece.sender, piece.data)
    yield line.flush()


def _told_to(codec: Codec, sender: str, told: Sequence[str]) -> list[str]:
    """Return what is told to the decoder of a sender: of parts that others have, nothing."""
    if not sender:
        return list(told)
    forms = find_senders(codec.protocol, sender)
    own = {part.name for form in forms for part in form.frame.told}
    others = set(codec.protocol.told) - own
    return [item for item in told if item.partition("=")[0] not in others]


# --- out ------------------------------------------------------------------------------------------


def _printer(codec: Codec, format: EventFormat, *, show_sender: bool) -> Show:
    from protogen.cli.console import console
    from protogen.cli.wire.event_lines import EventLines, json_line

    if format == "jsonl":
        return lambda event: typer.echo(json_line(event))
    from rich.text import Text

    out = console()
    lines = EventLines(codec.protocol, show_sender=show_sender)
    if out.is_terminal:
        return lambda event: out.print(Text.assemble(*lines.segments(event)))
    return lambda event: typer.echo(lines.text(event))
