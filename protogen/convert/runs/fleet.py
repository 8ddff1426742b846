"""Captures made into Parquet by many workers: what hands out the parts and puts them together.

Nothing is lost or doubled when a worker dies: Dask gives its part to another one, a part's files
have the names that they had, and they appear whole. When all parts of a capture fit each other, the
record of the folder says that it is done; then other files that earlier runs made of it go.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import CancelledError
from contextlib import contextmanager
from pathlib import Path
from pkgutil import resolve_name
from typing import Any

import msgspec

from protogen.convert.columns.batches import Tally
from protogen.convert.errors import ConvertError, needed
from protogen.convert.inputs.sources import Source, format_of
from protogen.convert.runs.byte_ranges import START
from protogen.convert.runs.capture_parts import Part, PartDone, Work, convert_part, read_marker
from protogen.convert.runs.conversion import (
    Advance,
    Complain,
    Fleet,
    Job,
    Result,
    check_origin,
    check_owner,
    check_room,
    forget_parts,
)
from protogen.convert.runs.journal import begin, finish, is_unfinished, part_name
from protogen.convert.runs.run_record import Done, State
from protogen.convert.writers.pending_files import remove
from protogen.copying import replace
from protogen.version import VERSION

LOCAL_CLUSTER: dict[str, Any] = {
    "threads_per_worker": 1,
    "dashboard_address": None,
    # Dask opens a port even so: any that is free, not one that it complains about.
    "scheduler_kwargs": {"dashboard_address": "127.0.0.1:0"},
}
"""Settings of a cluster on this machine, however many workers it has."""
_DEAF = "import signal; signal.signal(signal.SIGINT, signal.SIG_IGN)"
"""Code that workers on this machine run first. Ctrl-C is for the command, which ends them; they
would print a traceback each."""


class _Capture(msgspec.Struct):
    """A capture on its way: its parts, and what became of them."""

    name: str
    source: Source
    folder: Path
    format: str
    stamp: Mapping[str, Any]
    parts: list[Part]
    done: dict[int, PartDone] = msgspec.field(default_factory=dict)
    fitting: int = 0
    """Number of parts in front that are done and right: they are not looked at again."""

    def wrong(self) -> Iterator[tuple[int, Part]]:
        """Parts that began elsewhere than where the part in front of them ended, with its end.

        Only those whose part in front is right itself are told.
        """
        while self.fitting < len(self.parts):
            place = self.fitting
            done = self.done.get(place)
            if done is None:
                return
            right = self.done[place - 1].exit if place else START
            if done.entry != right:
                yield place, replace(self.parts[place], entry=right)
                return
            self.fitting += 1

    @property
    def is_done(self) -> bool:
        """True if all parts are there and fit each other."""
        return len(self.done) == len(self.parts) and not any(self.wrong())


def convert_fleet(
    job: Job,
    named: Sequence[tuple[str, Source]],
    fleet: Fleet,
    complain: Complain,
    advance: Advance,
) -> Iterator[Result]:
    """Convert captures with the workers of a fleet. Raises ConvertError and OSError."""
    for module in ("distributed", "pyarrow", "numpy"):
        needed(module, "--dask")
    state = State(job.folder)
    work = Work(job.protocol, job.sender.name, str(job.folder.absolute()), job.engine)
    waiting = []
    for name, source in named:
        if source.is_standard_input:
            raise ConvertError("standard input can't be read by workers", "give files or URLs")
        stamp = job.stamp(source)
        before = None if job.force else state.finished(f"{name}.{job.format}", stamp)
        if before is None:
            waiting.append(_planned(job, name, source, stamp, fleet.part_size))
        else:
            advance(stamp["size"] or 0)
            forget_parts(job, name, before.files)
            yield Result(source.place, before, was_done=True)
    if waiting:
        _check_names(waiting)
        for capture in waiting:
            _begin(job, state, capture)
        with _client(fleet, complain) as client:
            done: dict[str, Result] = {}
            parts = {it.name: [part.name for part in it.parts] for it in waiting}
            try:
                for capture in _Workers(client, work, advance).run(waiting, fresh=job.force):
                    done[capture.name] = _finished(job, state, capture, complain)
                    yield done[capture.name]
            finally:
                # Of all at once: it takes a look at every file that there is.
                files = [file for result in done.values() for file in result.done.files]
                finish(job.folder, {name: parts[name] for name in done}, files)


def _planned(
    job: Job, name: str, source: Source, stamp: Mapping[str, Any], part_size: int
) -> _Capture:
    format = format_of(source, job.input)
    size = stamp["size"]
    place = source.place if source.is_url else str(Path(source.place).absolute())
    kind = job.input and job.input.value
    if not format.is_plain or not size:
        whole = {**stamp, "span": None}
        parts = [Part(name, place, name, whole, kind)]
        return _Capture(name, source, job.folder, str(format), stamp, parts)
    parts = []
    for number, start in enumerate(range(0, size, part_size)):
        span = (start, min(size, start + part_size))
        of_part = {**stamp, "span": list(span)}
        part = Part(part_name(name, number), place, name, of_part, kind, size, span)
        parts.append(replace(part, entry=START) if number == 0 else part)
    return _Capture(name, source, job.folder, str(format), stamp, parts)


def _check_names(captures: Sequence[_Capture]) -> None:
    """Raise ConvertError where parts of two captures have one name: `run` and `run.000000`."""
    first: dict[str, _Capture] = {}
    for capture in captures:
        for part in capture.parts:
            other = first.setdefault(part.name, capture)
            if other is not capture:
                raise ConvertError(
                    f"parts of {other.source.place} and {capture.source.place} would both be"
                    f" called {part.name}",
                    "convert them into two folders, with --output",
                )


def _finished(job: Job, state: State, capture: _Capture, complain: Complain) -> Result:
    """Take note that a capture is done, and remove what is left of other attempts."""
    key = f"{capture.name}.{job.format}"
    parts = [capture.done[place] for place in range(len(capture.parts))]
    files = sorted(file for part in parts for file in part.files)
    tally = Tally()
    for part in parts:
        tally.add(part.tally)
    problems = [problem for part in parts for problem in part.complaints]
    for problem in problems:
        complain(f"{capture.source.place}: {problem}")
    remove(job.folder, [file for file in state.files(key) if file not in files])
    done = Done(capture.stamp, files, tally, capture.format, len(problems))
    state.record(key, done)
    return Result(capture.source.place, done)


# --- workers --------------------------------------------------------------------------------------


@contextmanager
def _client(fleet: Fleet, complain: Complain) -> Iterator[Any]:
    distributed = needed("distributed", "--dask")
    if fleet.address is not None:
        try:
            client = distributed.Client(fleet.address)  # Waits as long as Dask's settings say.
        except (OSError, ValueError, TypeError, ImportError) as error:
            # Dask tells a missing certificate or transport by a TypeError.
            raise ConvertError(f"no scheduler answers at {fleet.address}: {error}") from None
        with client:
            _check_workers(client, fleet.address, complain)
            yield client
        return
    # A worker's memory is what its decoders and row groups hold: the same for parts of any size.
    with (
        distributed.LocalCluster(
            n_workers=fleet.workers, **LOCAL_CLUSTER, **_preloads()
        ) as cluster,
        distributed.Client(cluster) as client,
    ):
        yield client


def _preloads() -> dict[str, Any]:
    """Code that workers on this machine run first: that of Dask's settings, and then ours.

    A setting may be one text, as that of an environment variable is. Where arguments are given one
    by one, there are as many as there are preloads.
    """
    config = needed("dask", "--dask").config
    given = config.get("distributed.worker.preload") or []
    arguments = config.get("distributed.worker.preload-argv") or []
    preloads = [given] if isinstance(given, str) else list(given)
    if arguments and not isinstance(arguments[0], str):
        arguments = [*arguments, []]
    return {"preload": [*preloads, _DEAF], "preload_argv": arguments}


def _check_workers(client: Any, address: str, complain: Complain) -> None:
    """Complain where there are no workers yet. Raises ConvertError where one lacks this protogen.

    A worker that can't import what it is given ends, and the rest of them would end like it.
    """
    found = client.run(resolve_name, "protogen.version:VERSION", on_error="return")
    if not found:
        complain(f"the scheduler at {address} has no workers; waiting for some")
    for worker, version in sorted(found.items()):
        if isinstance(version, ImportError):
            problem = "has no protogen"
        elif isinstance(version, str) and version != VERSION:
            problem = f"has protogen {version}, not {VERSION}"
        else:
            continue
        hint = f"install 'protogen-serial[dask]=={VERSION}' where the workers run"
        raise ConvertError(f"the worker {worker} {problem}", hint)


class _Workers:
    """Hands out parts and collects what becomes of them."""

    def __init__(self, client: Any, work: Work, advance: Advance) -> None:
        self._client = client
        # As the result of a task it can be had again when the workers that had it are gone.
        self._work = client.submit(_same, work, pure=False)
        self._advance = advance
        self._running: dict[Any, tuple[_Capture, int]] = {}
        self._collected = needed("distributed", "--dask").as_completed()

    def run(self, captures: Sequence[_Capture], *, fresh: bool) -> Iterator[_Capture]:
        """Yield each capture when its parts are done and fit each other.

        Unless `fresh`, parts that an earlier run did are not done again.
        """
        for capture in captures:
            for place, part in enumerate(capture.parts):
                earlier = None if fresh else read_marker(capture.folder, part)
                if earlier is None:
                    self._submit(capture, place, part)
                else:
                    capture.done[place] = earlier
                    self._advance(_size(part))
        for capture in captures:
            self._mend(capture)
        yield from (capture for capture in captures if capture.is_done)
        for future in self._collected:
            capture, place = self._running.pop(future)
            if place not in capture.done:
                self._advance(_size(capture.parts[place]))
            capture.done[place] = _result(future)
            self._mend(capture)
            if capture.is_done:
                yield capture

    def _submit(self, capture: _Capture, place: int, part: Part) -> None:
        future = self._client.submit(convert_part, self._work, part, pure=False, retries=2)
        self._running[future] = (capture, place)
        self._collected.add(future)

    def _mend(self, capture: _Capture) -> None:
        """Have a part that began at the wrong place done again, unless that is under way."""
        for place, part in capture.wrong():
            # To look there takes a while when there are many captures: not for what is right.
            if not any(it[0] is capture and it[1] == place for it in self._running.values()):
                self._submit(capture, place, part)


def _same(work: Work) -> Work:
    return work


def _begin(job: Job, state: State, capture: _Capture) -> None:
    """Take note that files of a capture's parts are ours from now on.

    Raises ConvertError where there are some already that no earlier run made.
    """
    check_origin(job, state, capture.name, capture.stamp)
    if not is_unfinished(job.folder, capture.name):
        names = [f"{part.name}.{job.format}" for part in capture.parts]
        tables = [table.name for table in job.tables.all_tables]
        # There may be a million: in a new folder, none is looked for.
        there = [table for table in tables if (job.folder / table).is_dir()]
        files = [f"{table}/{name}" for table in there for name in names]
        files = [file for file in files if (job.folder / file).exists()]
        check_room(job, state, files)
        check_owner(job, state, f"{capture.name}.{job.format}", files)
    begin(job.folder, capture.name, len(capture.parts))


def _size(part: Part) -> int:
    return part.span[1] - part.span[0] if part.span else part.stamp["size"] or 0


def _result(future: Any) -> PartDone:
    distributed = needed("distributed", "--dask")
    try:
        found: PartDone = future.result()
    except distributed.KilledWorker as error:
        raise ConvertError(
            f"workers died over and over at one part: {error}",
            "they may have too little memory: give fewer --workers",
        ) from None
    except CancelledError:
        raise ConvertError(
            "the scheduler is gone, or has dropped what was left to do",
            "give the command again: parts that are done are not done again",
        ) from None
    return found
