"""`protogen size`: the flash, RAM and stack that generated C takes on a machine."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Annotated, Literal

import typer

from protogen.cli.console import console, echo_json, print_table
from protogen.cli.exits import CLEAN, UsageError
from protogen.cli.generation import c_options
from protogen.cli.options import SchemaFile
from protogen.cli.schemas import find_message, find_sender, open_protocol

if TYPE_CHECKING:
    from protogen.footprint.report import Cost, Report
    from protogen.model.protocol import Protocol
    from protogen.targets.c.options import COptions, Events

EXAMPLE = "Example: protogen size schemas/rn1.yaml --mcu atmega328p --events messages --only gyro"
Mcu = Literal["atmega328p", "cortex-m0", "host"]
"""The machines of `protogen.footprint.machines`."""
_ROLES = ("encode", "decode", "frame", "send")
_DECODER_ROLES = ("init", "push", "feed", "flush")


def size(
    schema: SchemaFile,
    mcu: Annotated[Mcu, typer.Option(help="The machine to compile for.")] = "atmega328p",
    events: Annotated[
        Literal["all", "messages"],
        typer.Option(help="messages: without events for invalid and unknown frames."),
    ] = "all",
    only: c_options.Only = None,
    sender: c_options.Senders = None,
    format: Annotated[
        Literal["text", "json"], typer.Option(help="How to print: for people or programs.")
    ] = "text",
) -> int:
    """Print what the generated C of a schema takes: flash, RAM and stack.

    It is generated into a temporary folder and compiled with -Os. A function is counted with what
    it alone needs. A linker that drops unused sections takes only what a program calls.
    """
    from protogen.footprint.machines import MACHINES
    from protogen.footprint.report import report

    protocol = open_protocol(schema)
    measured = report(protocol, _options(protocol, events, only, sender), MACHINES[mcu])
    if format == "json":
        echo_json(_object(measured))
    else:
        _print_text(measured)
    return CLEAN


def _options(
    protocol: Protocol, events: Events, only: Sequence[str] | None, senders: Sequence[str] | None
) -> COptions:
    from protogen.targets.c.options import COptions

    for name in only or ():
        find_message(protocol, name)
    for name in senders or ():
        find_sender(protocol, name)
    options = COptions(
        events=events,
        only=tuple(only) if only else None,
        senders=tuple(senders) if senders else None,
    )
    if not options.chosen(protocol):
        raise UsageError(
            f"no message is left of `{protocol.name}`",
            "those of --only have to be sent by one of --sender",
        )
    return options


def _print_text(report: Report) -> None:
    out = console()
    out.print(f"{report.protocol} on {report.machine.title}, {report.compiler} -Os; bytes")
    out.print()
    print_table(out, ("message", *_ROLES, "shared", "flash", "stack", "struct"), _messages(report))
    out.print()
    print_table(out, ("decoder of", "flash", "stack", "RAM"), _decoders(report))
    out.print()
    print_table(out, ("", "flash", "RAM"), _totals(report))
    out.print()
    out.print("Stack is the deepest chain of calls, without your handlers and sinks.")
    if report.external:
        out.print(f"Not counted, from the compiler's library: {', '.join(report.external)}")


def _messages(report: Report) -> Iterator[tuple[str, ...]]:
    for cost in report.messages:
        flash = (sum(function.flash for function in cost.of(role)) for role in _ROLES)
        totals = (cost.shared, cost.flash, cost.stack, cost.struct)
        yield (cost.name, *map(_number, (*flash, *totals)))


def _decoders(report: Report) -> Iterator[tuple[str, ...]]:
    for cost in report.decoders:
        yield (cost.name, *map(_number, (cost.flash, cost.stack, cost.struct)))


def _totals(report: Report) -> Iterator[tuple[str, ...]]:
    messages = sum(cost.flash for cost in report.messages)
    yield ("messages", _number(messages), "")
    decoders = sum(cost.flash for cost in report.decoders)
    yield ("decoders", _number(decoders), _number(sum(cost.struct for cost in report.decoders)))
    yield ("shared by them", _number(report.shared), _number(report.static))
    yield ("dispatch and empty handlers", _number(report.handlers), "")
    yield ("total", _number(report.flash), _number(report.ram))


def _number(value: int) -> str:
    return f"{value:,}"


def _object(report: Report) -> dict[str, object]:
    return {
        "protocol": report.protocol,
        "mcu": report.machine.name,
        "compiler": report.compiler,
        "messages": [_cost(cost, _ROLES) for cost in report.messages],
        "decoders": [_cost(cost, _DECODER_ROLES) for cost in report.decoders],
        "shared_flash": report.shared,
        "handlers_flash": report.handlers,
        "static_ram": report.static,
        "flash": report.flash,
        "ram": report.ram,
        "not_counted": list(report.external),
    }


def _cost(cost: Cost, roles: Sequence[str]) -> dict[str, object]:
    functions = [
        {"role": role, "name": item.name, "flash": item.flash, "stack": item.stack}
        for role in roles
        for item in cost.of(role)
    ]
    return {
        "name": cost.name,
        "functions": functions,
        "shared_flash": cost.shared,
        "flash": cost.flash,
        "stack": cost.stack,
        "struct": cost.struct,
    }
