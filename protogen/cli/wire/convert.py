"""`protogen convert`: captures -> tables."""

from __future__ import annotations

import re
import warnings
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from protogen.cli.command import Command
from protogen.cli.exits import CLEAN, FINDINGS, UsageError
from protogen.cli.options import Quiet, SchemaFile, SenderOfBytes
from protogen.cli.schemas import find_sender
from protogen.cli.wire.complaints import Complaints
from protogen.convert.formats import InputKind, OutputFormat

if TYPE_CHECKING:
    from protogen.convert.inputs.sources import Source
    from protogen.convert.runs.conversion import Fleet, Job, Result
    from protogen.model.protocol import Protocol, Sender

EXAMPLE = "Example: protogen convert rover.yaml --sender board run.bin --to parquet -o tables"

OUTPUT = Path("converted")


def convert(  # noqa: PLR0913 - each option is one argument
    schema: SchemaFile,
    captures: Annotated[
        list[str],
        typer.Argument(
            metavar="CAPTURE...|-",
            help="Files or URLs that fsspec knows: raw bytes, recordings, text logs with times,"
            " hex digits, also compressed by gzip or zstd; - is standard input.",
        ),
    ],
    to: Annotated[OutputFormat, typer.Option("--to", help="What tables are written as.")],
    sender: SenderOfBytes = None,
    output: Annotated[
        Path, typer.Option("--output", "-o", metavar="DIR", help="Where the tables go.")
    ] = OUTPUT,
    input: Annotated[
        InputKind | None,
        typer.Option(
            "--input", help="What captures are written in; without it, that is found out."
        ),
    ] = None,
    force: Annotated[
        bool,
        typer.Option(
            "--force", help="Do what is done again, and replace files that somebody else made."
        ),
    ] = False,
    dask: Annotated[
        str | None,
        typer.Option(
            "--dask",
            metavar="[ADDRESS]",
            help="Let the workers of a Dask scheduler do it, to Parquet; without an address,"
            " workers on this machine.",
        ),
    ] = None,
    workers: Annotated[
        int | None,
        typer.Option("--workers", min=1, metavar="N", help="With --dask: how many here."),
    ] = None,
    part_size: Annotated[
        int | None,
        typer.Option(
            "--part-size", min=1, metavar="MB", help="With --dask: megabytes of a part, else 256."
        ),
    ] = None,
    quiet: Quiet = False,
) -> int:
    """Make tables of captures: one for each message, with raw and physical values.

    Files appear whole or not at all. After an interruption the same command goes on with the first
    capture that is not done. Exits with 1 if a line or record of a log can't be used, as its bytes
    are lost.
    """
    from protogen.cli.wire.codec import open_codec
    from protogen.convert.runs.conversion import Job

    codec = open_codec(schema)
    sent = _sender(codec.protocol, sender)
    job = Job(codec.protocol, codec.runtime, sent, to, output, input, force)
    complaints = Complaints()
    fleet = _fleet(to, dask, workers, part_size)
    results = _run(job, captures, fleet, complaints)
    if not quiet:
        for result in results:
            _print_result(result, output)
    complaints.report()
    return FINDINGS if any(result.done.lost_lines for result in results) else CLEAN


def _sender(protocol: Protocol, name: str | None) -> Sender:
    """Return who sent the capture. Raises UsageError if that is not clear."""
    if name is not None:
        return find_sender(protocol, name)
    if len(protocol.senders) == 1:
        return protocol.senders[0]
    names = " or ".join(sender.name for sender in protocol.senders)
    raise UsageError("nothing says who sent the bytes", f"give --sender {names}")


LOCAL = "local"
"""Stands for the address of workers on this machine."""
_ADDRESS = re.compile(r"(?:tcp|tls|ucx|wss?|inproc)://.*|[\w.-]+:\d+")


class ConvertCommand(Command):
    """The command, whose option `--dask` goes with and without an address."""

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """Read the arguments. Raises BadParameter."""
        written = []
        for word, following in zip(args, [*args[1:], ""], strict=True):
            bare = word == "--dask" and not _ADDRESS.fullmatch(following)
            written.append(f"--dask={LOCAL}" if bare else word)
        return super().parse_args(ctx, written)


CLASS = ConvertCommand


def _fleet(
    to: OutputFormat, address: str | None, workers: int | None, part_size: int | None
) -> Fleet | None:
    if address is None:
        for option, given in (("--workers", workers), ("--part-size", part_size)):
            if given is not None:
                raise UsageError(f"{option} is for --dask", "add --dask, or leave it out")
        return None
    from protogen.convert.runs.conversion import PART_SIZE, Fleet

    if to is not OutputFormat.PARQUET:
        raise UsageError("--dask makes Parquet", "give --to parquet")
    if address != LOCAL and workers is not None:
        raise UsageError("--workers is for workers on this machine, not for a scheduler's")
    size = PART_SIZE if part_size is None else part_size * 1_000_000
    return Fleet(None if address == LOCAL else address, workers, size)


def _run(
    job: Job, captures: Sequence[str], fleet: Fleet | None, complaints: Complaints
) -> list[Result]:
    from protogen.cli.progress import progress
    from protogen.convert.runs.conversion import convert, plan

    named = plan(job, captures)
    total = _total(source for _, source in named)
    with _plain_warnings(), progress("converting", total, in_bytes=True) as advance:
        if fleet is None:
            return list(convert(job, named, complaints.add, advance))
        from protogen.convert.runs.fleet import convert_fleet

        return list(convert_fleet(job, named, fleet, complaints.add, advance))


@contextmanager
def _plain_warnings() -> Iterator[None]:
    """Let warnings be said as commands say them, without the line of protogen that warns."""
    from protogen.capture.errors import NoSilenceWarning, SlowCaptureWarning

    def show(message: Any, category: Any, *where: Any, **more: Any) -> None:
        if issubclass(category, NoSilenceWarning | SlowCaptureWarning):
            typer.echo(f"warning: {message}", err=True)
        else:
            usual(message, category, *where, **more)

    usual = warnings.showwarning
    warnings.showwarning = show
    try:
        yield
    finally:
        warnings.showwarning = usual


def _total(sources: Iterable[Source]) -> int | None:
    """The size of all captures together, where it is known."""
    sizes = [source.stamp()[0] for source in sources]
    return None if None in sizes else sum(size or 0 for size in sizes)


# --- the summary ----------------------------------------------------------------------------------


def _print_result(result: Result, folder: Path) -> None:
    if result.was_done:
        typer.echo(f"{result.place}: done before, nothing has changed since")
    else:
        typer.echo(f"{result.place}: {result.done.format}, {result.done.tally.bytes} bytes")
    amounts = _amounts(result)
    width = max([24, *(len(name) for name, _ in amounts)])
    for name, amount in amounts:
        typer.echo(f"  {name:<{width}} {amount}")
    if not result.was_done:
        tables = [file for file in result.done.files if not file.endswith(".columns.json")]
        typer.echo(f"  wrote {len(tables)} {'file' if len(tables) == 1 else 'files'} in {folder}")


def _amounts(result: Result) -> list[tuple[str, str]]:
    tally = result.done.tally
    amounts = [(name, f"{count:>12}") for name, count in sorted(tally.messages.items())]
    if tally.unknown:
        amounts.append(("unknown frames", f"{tally.unknown:>12}"))
    for reason, count in sorted(tally.invalid.items()):
        amounts.append((f"invalid: {reason}", f"{count:>12} bytes"))
    return amounts
