"""`protogen fuzz`: round trips of every message."""

from __future__ import annotations

import json
from collections import Counter
from typing import TYPE_CHECKING, Annotated

import msgspec
import typer

from protogen.cli.exits import CLEAN, FINDINGS
from protogen.cli.options import SchemaFile

if TYPE_CHECKING:
    from protogen.cli.wire.codec import Codec
    from protogen.fuzzing.engine import Engine
    from protogen.fuzzing.trips import Outcome
    from protogen.model.protocol import Protocol

EXAMPLE = "Example: protogen fuzz schemas/rn1.yaml --examples 1000"

_GREATEST_SEED = 1 << 32
_LONGEST_TEXT = 400


def fuzz(
    schema: SchemaFile,
    examples: Annotated[
        int,
        typer.Option(min=1, metavar="N", help="Samples of each message; boundaries come first."),
    ] = 100,
    message: Annotated[str | None, typer.Option(metavar="NAME", help="Only this message.")] = None,
    seed: Annotated[
        int | None, typer.Option(help="The seed of an earlier run. Default: another each time.")
    ] = None,
) -> int:
    """Take samples of every message there and back.

    Values to a payload and back, values to a frame, through a decoder and back; by every engine
    that there is: generated Python, and generated C where there is a C compiler, which has to make
    the same frames. The samples hold the boundaries of every field. Exits with 1 if anything comes
    back in another way.
    """
    from random import SystemRandom

    from protogen.cli.schemas import find_message
    from protogen.cli.wire.codec import fresh_codec

    codec = fresh_codec(schema)
    if message is not None:
        find_message(codec.protocol, message)
    run = Run(examples, SystemRandom().randrange(_GREATEST_SEED) if seed is None else seed, message)
    engines, are_whole = _engines(codec)
    tallies = _tallies(codec.protocol, engines, run)
    for tally in tallies:
        tally.print(run.seed)
    return FINDINGS if any(tally.failed for tally in tallies) or not are_whole else CLEAN


class Run(msgspec.Struct, frozen=True):
    """Selection of samples."""

    examples: int
    seed: int
    message: str | None


def _engines(codec: Codec) -> tuple[list[Engine], bool]:
    """Return every engine that there is, and whether none is broken. The first is the reference."""
    from protogen.fuzzing.c_engine import CEngine
    from protogen.fuzzing.c_library import CompileError, find_compiler
    from protogen.fuzzing.python_engine import PythonEngine
    from protogen.targets.c.fuzz_driver.driver import driver_of

    found: list[Engine] = [
        PythonEngine(codec.runtime),
        PythonEngine(codec.runtime, codec.module.encode),
    ]
    compiler = find_compiler()
    if compiler is None:
        typer.echo("c: there is no C compiler (cc, gcc or clang), so generated C is not tried")
        return found, True
    try:
        return [*found, CEngine(driver_of(codec.protocol), compiler)], True
    except CompileError as error:
        typer.echo(f"c: {compiler} refuses the generated C:\n{error}", err=True)
        return found, False


def _tallies(protocol: Protocol, engines: list[Engine], run: Run) -> list[_Tally]:
    """Take every sample through all engines, and return what became of it in each."""
    from protogen.cli.progress import progress
    from protogen.fuzzing.trips import case_count, cases, smallest, try_engines

    tallies = [_Tally(engine) for engine in engines]
    total = case_count(protocol, run.examples, run.message)
    with progress(f"{protocol.name} through {len(engines)} engines", total) as advance:
        for case in cases(protocol, run.examples, run.seed, run.message):
            for tally, outcome in zip(tallies, try_engines(engines, protocol, case), strict=True):
                shown = outcome
                if tally.is_first_failure(outcome):
                    reference = None if tally.engine is engines[0] else engines[0]
                    shown = smallest(tally.engine, protocol, outcome, reference)
                tally.add(shown)
            advance(1)
    return tallies


class _Tally:
    """Counts of one engine's samples, and the first failure of each message."""

    def __init__(self, engine: Engine) -> None:
        self.engine = engine
        self._tried, self._refused = Counter[str](), Counter[str]()
        self._failures: dict[str, Outcome] = {}
        self._reasons: dict[str, str] = {}

    def is_first_failure(self, outcome: Outcome) -> bool:
        """True if a message fails that has not failed before."""
        return bool(outcome.problem) and outcome.case.message not in self._failures

    def add(self, outcome: Outcome) -> None:
        """Count a sample."""
        message = outcome.case.message
        self._tried[message] += 1
        if outcome.problem:
            self._failures.setdefault(message, outcome)
        if outcome.refused:
            self._refused[message] += 1
            self._reasons[message] = outcome.refused

    @property
    def _never(self) -> list[str]:
        return [name for name, count in self._refused.items() if count == self._tried[name]]

    @property
    def failed(self) -> int:
        """Number of messages that failed, or of which no sample could be encoded."""
        return len(self._failures.keys() | self._never)

    def print(self, seed: int) -> None:
        """Print the failures, and one line about all samples."""
        for failure in self._failures.values():
            _print_failure(failure, self.engine, seed)
        for name in self._never:
            reason = self._reasons[name]
            typer.echo(f"{name} through {self.engine.name}: no sample can be encoded: {reason}")
        _print_summary(self.engine, self._tried.total(), self._refused.total(), self.failed, seed)


def _print_failure(failure: Outcome, engine: Engine, seed: int) -> None:
    from protogen.cli.console import console

    out = console()
    case = failure.case
    out.print(f"{case.message}, sent by {case.sender}, through {engine.name}:", style="bold red")
    out.print(f"  {_shortened(failure.problem)}")
    out.print(f"  fields: {_shortened(json.dumps(case.values))}")
    out.print(f"  parts:  {_shortened(json.dumps(case.parts))}")
    if failure.frame:
        out.print(f"  frame:  {_shortened(failure.frame.hex(' ').upper())}")
    out.print(f"  again:  --seed {seed} --message {case.message}")


def _shortened(text: str) -> str:
    """Return the beginning and the end of a long text; the seed gives the whole sample again."""
    if len(text) <= _LONGEST_TEXT:
        return text
    half = _LONGEST_TEXT // 2
    return f"{text[:half]} ... {text[-half:]} ({len(text)} characters)"


def _print_summary(engine: Engine, tried: int, refused: int, failed: int, seed: int) -> None:
    wrong = f"{failed} message{'s fail' if failed > 1 else ' fails'}" if failed else "all came back"
    kept = f", {refused} were refused because a decoder would cut them elsewhere" if refused else ""
    typer.echo(f"{engine.name}: {tried} samples, {wrong}{kept} (seed {seed})")
