"""`protogen simulate`: a device that is not there."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from protogen.cli.exits import CLEAN, UsageError
from protogen.cli.line.options import (
    Delay,
    Drop,
    Flip,
    Seconds,
    Seed,
    damage_rates,
    line_settings,
)
from protogen.cli.line.running import run_until_stopped
from protogen.cli.options import SchemaFile

if TYPE_CHECKING:
    from collections.abc import Sequence

    from protogen.cli.wire.codec import Codec
    from protogen.link.answers import AnswerRates
    from protogen.link.ports.settings import LineSettings
    from protogen.link.simulated_values import ValueFunction, ValueSource
    from protogen.link.simulation import Counts, Simulation
    from protogen.model.protocol import Protocol

EXAMPLE = "Example: protogen simulate rover.yaml --endpoint board --rate state=50"


def simulate(  # noqa: PLR0913 - each option is one argument
    schema: SchemaFile,
    endpoint: Annotated[str | None, typer.Option(metavar="NAME", help="Who the device is.")] = None,
    port: Annotated[
        str | None, typer.Option(metavar="PORT", help="A port to be the device on.")
    ] = None,
    pty: Annotated[
        bool, typer.Option("--pty", help="Make a pseudo-terminal; that is what is done by default.")
    ] = False,
    listen: Annotated[
        str | None, typer.Option(metavar="[HOST]:PORT", help="Wait for a connection by TCP.")
    ] = None,
    rate: Annotated[
        list[str] | None,
        typer.Option(
            metavar="MESSAGE=HZ",
            help="How often to send a message, in place of its schema's rate; 0: not at all. May be"
            " repeated.",
        ),
    ] = None,
    values: Annotated[
        str,
        typer.Option(
            metavar="examples|random|FILE",
            help="Values: of the examples in turn, random ones in their ranges, those of a"
            " recording, or of a function: FILE.py:NAME takes message and seconds.",
        ),
    ] = "examples",
    seconds: Seconds = None,
    silent: Annotated[bool, typer.Option("--silent", help="Answer no requests.")] = False,
    refuse: Annotated[
        float, typer.Option(min=0, max=1, help="Share of requests to refuse, from 0 to 1.")
    ] = 0.0,
    ignore: Annotated[
        float, typer.Option(min=0, max=1, help="Share of requests not to answer, from 0 to 1.")
    ] = 0.0,
    drop: Drop = 0.0,
    flip: Flip = 0.0,
    delay: Delay = 0.0,
    seed: Seed = 0,
) -> int:
    """Be a device: send messages at their rates, answer requests, and say what comes in.

    Requests are answered as the schema's exchanges say. Prints the name of the port that a program
    has to open. Frames for which nobody reads are lost, as on any line. Ends with Ctrl-C.
    """
    from protogen.cli.wire.codec import open_codec
    from protogen.link.damage import Damage
    from protogen.link.simulation import Simulation

    codec = open_codec(schema)
    endpoint = _endpoint(codec.protocol, endpoint)
    address = _address(port, pty=pty, listen=listen)
    rates = _rates(codec.protocol, endpoint, rate or ())
    damage = damage_rates(drop, flip, delay)
    simulation = Simulation(
        codec.protocol,
        codec.module,
        endpoint,
        rates,
        _values(codec, endpoint, values, seed),
        None if damage.is_none else Damage(damage, seed),
    )
    answers = _answers(codec.protocol, endpoint, refuse, ignore, silent=silent)
    if answers is not None:
        simulation.answer_requests(answers, seed)
    if simulation.is_idle:
        first = next(m.name for m in codec.protocol.messages if endpoint in m.senders)
        typer.echo(f"hint: nothing is sent by itself; give --rate {first}=10", err=True)
    settings = line_settings(codec.protocol.link, None, None, None)
    run_until_stopped(lambda: _simulate(simulation, address, settings), seconds)
    _report(simulation.counts)
    return CLEAN


def _answers(
    protocol: Protocol, endpoint: str, refuse: float, ignore: float, *, silent: bool
) -> AnswerRates | None:
    """How requests are answered; None: they are not. Raises UsageError for what can't be."""
    from protogen.link.answers import AnswerRates, can_refuse

    if silent and (refuse or ignore):
        raise UsageError("--silent answers no request at all", "leave out --refuse and --ignore")
    if refuse + ignore > 1:
        raise UsageError("--refuse and --ignore are more than 1 together", "give smaller shares")
    if refuse and not can_refuse(protocol, endpoint):
        hint = "name one in the schema: `refusal: ...` beside the `reply` of an exchange"
        raise UsageError(f"no exchange of {protocol.name} has a refusal of {endpoint}", hint)
    return None if silent else AnswerRates(refuse=refuse, ignore=ignore)


async def _simulate(simulation: Simulation, address: str, settings: LineSettings) -> None:
    from protogen.link.ports.opening import open_port

    async with await open_port(address, settings) as port:
        typer.echo(port.name)
        await simulation.run(port)


def _report(counts: Counts) -> None:
    for what, numbers in (("sent", counts.sent), ("received", counts.received)):
        for name, number in numbers.items():
            typer.echo(f"{what} {number:,} {name}", err=True)
    if counts.lost:
        typer.echo(f"lost {counts.lost:,}, as nobody read", err=True)


def _endpoint(protocol: Protocol, endpoint: str | None) -> str:
    """The endpoint to be. Raises UsageError where it is none, or none is said."""
    from protogen.problems import hint_for

    known = protocol.sending
    if endpoint is None and len(known) == 1:
        return known[0]
    if endpoint in known:
        return str(endpoint)
    choices = " or ".join(f"--endpoint {name}" for name in known)
    if endpoint is None:
        raise UsageError("it is not said which endpoint the device is", f"give {choices}")
    hint = hint_for(endpoint, known) or f"give {choices}"
    raise UsageError(f"`{endpoint}` is no endpoint of {protocol.name} that sends", hint)


def _address(port: str | None, *, pty: bool, listen: str | None) -> str:
    """The address of the device's own end. Raises UsageError for two of them."""
    given = [item for item in (port, "pty:" if pty else None, listen) if item is not None]
    if len(given) > 1:
        raise UsageError("--port, --pty and --listen exclude each other", "give one of them")
    if listen is not None:
        return f"listen://{listen if ':' in listen else f':{listen}'}"
    return given[0] if given else "pty:"


def _rates(protocol: Protocol, endpoint: str, given: Sequence[str]) -> dict[str, float]:
    """How often each message is sent, in Hz. Raises UsageError, ValuesError."""
    from protogen.link.simulation import rates_of

    rates: dict[str, float] = {}
    for text in given:
        name, _, number = text.partition("=")
        try:
            rates[name] = float(number)
        except ValueError:
            problem = f"`{text}` does not say how often {name} is sent"
            hint = f"write {name}=10 for ten times a second, or {name}=0"
            raise UsageError(problem, hint) from None
    return rates_of(protocol, endpoint, rates)


def _values(codec: Codec, endpoint: str, chosen: str, seed: int) -> ValueSource:
    """Where values come from. Raises UsageError, PortError or ValuesError."""
    from protogen.link import simulated_values
    from protogen.link.ports.recording import pieces_of, sources_of
    from protogen.problems import hint_for

    protocol = codec.protocol
    if chosen == "random":
        return simulated_values.random_values(protocol, endpoint, seed)
    examples = simulated_values.example_values(protocol, endpoint, seed)
    if chosen == "examples":
        return examples
    file, _, function = chosen.rpartition(":")
    if chosen.endswith(".py"):
        problem = f"`{chosen}` does not say which function gives the values"
        raise UsageError(problem, f"write {chosen}:NAME")
    if file.endswith(".py"):
        return simulated_values.computed_values(examples, _function(Path(file), function))
    if not Path(chosen).exists():
        problem = f"--values {chosen} is none of: examples, random, a recording, FILE.py:NAME"
        raise UsageError(problem, hint_for(chosen, ("examples", "random")))
    source = endpoint if endpoint in sources_of(chosen) else None
    return simulated_values.recorded_values(
        codec.module, endpoint, pieces_of(chosen, source), examples
    )


def _function(file: Path, name: str) -> ValueFunction:
    """A function of a user's file. Raises UsageError where it is not there."""
    import runpy

    if not file.is_file():
        raise UsageError(f"there is no file {file}")
    try:
        found = runpy.run_path(str(file)).get(name)
    except Exception as error:  # It is the user's own program.
        raise UsageError(f"{file}: {type(error).__name__}: {error}") from None
    if not callable(found):
        raise UsageError(f"{file} has no function `{name}`", f"define {name}(message, seconds)")
    return found  # type: ignore[no-any-return]
