"""One run: captures in, files in their places."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from functools import cached_property
from pathlib import Path
from typing import Any

import msgspec

from protogen.convert.columns.batches import BatchDecoder, Tally, batches_of
from protogen.convert.columns.tables import Tables, tables_of
from protogen.convert.errors import ConvertError
from protogen.convert.formats import InputKind, OutputFormat
from protogen.convert.inputs.sources import Source, expanded, opened
from protogen.convert.runs.folder_locks import alone
from protogen.convert.runs.journal import finish, is_unfinished
from protogen.convert.runs.run_record import Done, State
from protogen.convert.runs.table_names import names_of
from protogen.convert.writers.format_writers import first_files, open_writer, require, write_all
from protogen.convert.writers.pending_files import Pending, forget_torn, name_place, remove
from protogen.model.protocol import Protocol, Sender
from protogen.runtime.codec import Protocol as RuntimeProtocol

_ORIGIN = ("capture", "protocol", "sender")
"""Keys of a stamp that say what tables are made of, whatever becomes of it."""
PART_SIZE = 256_000_000
"""Bytes of a capture in a part, unless somebody says otherwise."""
Complain = Callable[[str], None]
Advance = Callable[[int], None]


class Job(msgspec.Struct, frozen=True, dict=True):
    """Order for a conversion: whose bytes, from which format to which, and where they go."""

    protocol: Protocol
    runtime: RuntimeProtocol[Any, Any]
    sender: Sender
    format: OutputFormat
    folder: Path
    input: InputKind | None = None
    """None: what the capture turns out to be."""
    force: bool = False
    """True if files that no earlier run made may be replaced, and what is done is done again."""
    engine: str | None = None
    """Decoder: `native`, `python`, or `events`, which needs no NumPy; None: the fastest."""

    @cached_property
    def tables(self) -> Tables:
        """The tables that the conversion fills."""
        return tables_of(self.protocol, self.sender)

    def decoder(self) -> BatchDecoder:
        """A decoder of a capture."""
        from protogen.convert.columns.decoders import open_decoder

        spec = self.runtime.sender(self.sender.name)
        return open_decoder(self.tables, spec, self.format, self.engine)

    def stamp(self, source: Source) -> dict[str, Any]:
        """All that the result depends on, to see whether an earlier one still holds."""
        size, changed = source.stamp()
        return {
            "capture": source.identity,
            "size": size,
            "changed": changed,
            "input": self.input and self.input.value,
            "protocol": self.protocol.name,
            "sender": self.sender.name,
            "spec_hash": self.protocol.spec_hash,
            "version": self.tables.invalid.facts["protogen.version"],
        }


class Fleet(msgspec.Struct, frozen=True):
    """Workers: those of a scheduler's address, or with None on this machine."""

    address: str | None = None
    workers: int | None = None
    part_size: int = PART_SIZE


class Result(msgspec.Struct, frozen=True):
    """Result of one capture."""

    place: str
    done: Done
    was_done: bool = False
    """True if an earlier run did it."""


def plan(job: Job, places: Sequence[str]) -> list[tuple[str, Source]]:
    """The captures, each with the name of its files. Raises ConvertError."""
    require(job.format)
    places = expanded(places)
    sources = [Source(place) for place in places]
    names = names_of(places)
    for source in sources:
        source.stamp()
    return list(zip(names, sources, strict=True))


def convert(
    job: Job, named: Sequence[tuple[str, Source]], complain: Complain, advance: Advance
) -> Iterator[Result]:
    """Convert one capture after another. Raises ConvertError and OSError."""
    state = State(job.folder)
    for name, source in named:
        key = f"{name}.{job.format}"
        stamp = job.stamp(source)
        done = None if job.force else state.finished(key, stamp)
        was_done = done is not None
        if done is None:
            with alone(job.folder, key):
                state.refresh()
                check_origin(job, state, name, stamp)
                done = _convert_one(job, name, source, state, complain, advance)
            state.record(key, done)  # After all else: what is recorded is not looked at again.
        else:
            advance(stamp["size"])
        forget_parts(job, name, done.files)
        yield Result(source.place, done, was_done)


def _convert_one(
    job: Job, name: str, source: Source, state: State, complain: Complain, advance: Advance
) -> Done:
    lost = 0

    def lose(problem: str) -> None:
        nonlocal lost
        lost += 1
        complain(f"{source.place}: {problem}")

    stamp = job.stamp(source)
    pending = Pending(job.folder)
    tally = Tally()
    senders = [sender.name for sender in job.protocol.senders]
    try:
        with opened(source, job.input, job.sender.name, senders, lose, advance) as capture:
            writer = open_writer(job.format, name, pending, job.tables)
            write_all(writer, batches_of(job.decoder(), capture.chunks), tally)
            _make_room(job, f"{name}.{job.format}", pending.relatives, stamp, state)
            files = pending.commit()
            forget_torn(job.folder, first_files(job.format, name, job.tables))
    except BaseException as error:
        pending.discard()
        name_place(error, job.folder)
        raise
    return Done(stamp, files, tally, str(capture.format), lost)


def forget_parts(job: Job, name: str, files: Sequence[str]) -> None:
    """Remove what a fleet left that was ended while it made a capture, but for these files."""
    if job.format is OutputFormat.PARQUET and is_unfinished(job.folder, name):
        finish(job.folder, {name: ()}, files)


def check_room(job: Job, state: State, files: Iterable[str]) -> None:
    """Raise ConvertError where one of the files is there and no earlier run made it."""
    for file in files:
        if (job.folder / file).exists() and not (job.force or state.owns(file)):
            raise ConvertError(
                f"{job.folder / file} is there already, and no earlier run made it",
                "name another folder with --output, or replace it with --force",
            )


def check_owner(job: Job, state: State, key: str, files: Iterable[str]) -> None:
    """Raise ConvertError where one of the files is there and was made of another capture.

    As `x.part-0001`, when the tables of `x` go on in files of that name.
    """
    for file in files:
        if (job.folder / file).exists() and state.is_of_another(key, file):
            raise ConvertError(
                f"{job.folder / file} is there already, made of another capture",
                "name another folder with --output for one of them",
            )


def check_origin(job: Job, state: State, name: str, stamp: Mapping[str, Any]) -> None:
    """Raise ConvertError where files of this name are there that are made of something else.

    A capture that has changed, or a schema that has, is not something else.
    """
    key = f"{name}.{job.format}"
    earlier = state.origin(key)
    there = any((job.folder / file).exists() for file in state.files(key))
    if job.force or not there or all(earlier.get(word) in (None, stamp[word]) for word in _ORIGIN):
        return
    raise ConvertError(
        f"{job.folder} has tables called {name} of {earlier['capture']}, sent by"
        f" {earlier['sender']} of {earlier['protocol']}",
        "name another folder with --output, or replace them with --force",
    )


def _make_room(
    job: Job, key: str, files: Sequence[str], stamp: Mapping[str, Any], state: State
) -> None:
    """Remove what an earlier run made of a capture. Raises ConvertError for files of others."""
    check_room(job, state, files)
    check_owner(job, state, key, files)
    stale = [file for file in state.files(key) if file not in files]
    state.expect(key, files, {word: stamp[word] for word in _ORIGIN})
    remove(job.folder, stale)
