"""`protogen send`: a message onto a line, and what answers it."""

from __future__ import annotations

import asyncio
from collections import Counter
from typing import TYPE_CHECKING, Annotated, Any, Literal

import typer

from protogen.cli.exits import CLEAN, FINDINGS, UsageError
from protogen.cli.line.options import Baud, Dtr, PortText, Rts, named_port
from protogen.cli.options import SchemaFile
from protogen.cli.wire.encode import Assignments

if TYPE_CHECKING:
    from protogen.cli.wire.codec import Codec
    from protogen.cli.wire.given import GivenMessage
    from protogen.link import Link
    from protogen.link.connection import Options

EXAMPLE = "Example: protogen send rover.yaml /dev/ttyUSB0 drive left=500 right=500"

_DEFAULT_TIMEOUT = 1.0


def send(  # noqa: PLR0913 - each option is one argument
    schema: SchemaFile,
    port: PortText,
    message: Annotated[str, typer.Argument(metavar="MESSAGE", help="The message.")],
    values: Assignments = None,
    expect: Annotated[
        str | None,
        typer.Option(metavar="MESSAGE", help="Wait for this message, and print it."),
    ] = None,
    timeout: Annotated[
        float | None,
        typer.Option(
            min=0, metavar="SECONDS", help="How long to wait. Default: as the schema says, or 1."
        ),
    ] = None,
    retries: Annotated[
        int | None,
        typer.Option(min=0, help="How often to send it again. Default: as the schema says."),
    ] = None,
    sender: Annotated[
        str | None, typer.Option(metavar="NAME", help="Who sends it, where several can.")
    ] = None,
    format: Annotated[
        Literal["text", "jsonl"], typer.Option(help="One readable line, or one of JSON.")
    ] = "text",
    baud: Baud = None,
    dtr: Dtr = None,
    rts: Rts = None,
) -> int:
    """Send a message, and wait for what answers it.

    What answers it stands in the schema's `exchanges`, with how the reply is told, how long to wait
    and how often to send it again. Without an exchange, nothing is waited for. With --expect NAME,
    that message is waited for: as the reply or the refusal, if it is one, else the first that comes
    afterwards. Exits with 1 if there was no reply, or another one, or a refusal.
    """
    from protogen.cli.schemas import find_message
    from protogen.cli.wire.codec import open_codec
    from protogen.cli.wire.given import given_message

    codec = open_codec(schema)
    given = given_message(codec, message, values or [], sender, None)
    if expect is not None:
        find_message(codec.protocol, expect)
    options: Options = {"dtr": dtr, "rts": rts, "lasting": False}
    peer, port = named_port(port, codec.protocol)
    if peer:
        options["peer"] = peer
    if baud is not None:
        options["baud"] = baud
    return asyncio.run(_talk(codec, port, given, _Wait(expect, timeout, retries), format, options))


class _Wait:
    """What is waited for."""

    def __init__(self, expect: str | None, timeout: float | None, retries: int | None) -> None:
        self.expect = expect
        self.timeout = timeout
        self.retries = retries


async def _talk(
    codec: Codec, port: str, given: GivenMessage, wait: _Wait, format: str, options: Options
) -> int:
    from protogen.link import NoReplyError, RefusedError, connect

    async with connect(codec.module, port, given.specs[0].name, **options) as link:
        try:
            with given.explained():
                event = await _answer(codec, link, given, wait)
        except RefusedError as error:
            is_expected = wait.expect == error.refusal.NAME
            typer.echo(str(error) if is_expected else f"error: {error}", err=not is_expected)
            return CLEAN if is_expected else FINDINGS
        except NoReplyError as error:
            typer.echo(f"error: {error}\n  hint: {error.hint}", err=True)
            return FINDINGS
    if event is None:
        return CLEAN
    _print(codec, event, format)
    name = event.message.NAME
    if wait.expect not in (None, name):
        typer.echo(f"error: the reply is {name}, not {wait.expect}", err=True)
        return FINDINGS
    return CLEAN


async def _answer(codec: Codec, link: Link[Any, Any], given: GivenMessage, wait: _Wait) -> Any:
    """The event that answers a message; None where nothing is waited for."""
    kind = type(given.record)
    exchange = next((item for item in codec.runtime.exchanges if kind in item.requests), None)
    answers = () if exchange is None else (*exchange.replies, *exchange.refusals)
    if wait.expect is not None and wait.expect not in {item.NAME for item in answers}:
        return await _expected(link, given, wait)
    if exchange is None:
        await link.send(given.record, **given.parts)
        return None
    events = link.events()
    reply = await link.request(
        given.record, timeout=wait.timeout, retries=wait.retries, **given.parts
    )
    async for heard in events:
        if heard.event.kind == "message" and heard.event.message is reply:
            return heard.event
    return None


async def _expected(link: Link[Any, Any], given: GivenMessage, wait: _Wait) -> Any:
    """The first message of the kind that the user waits for."""
    from protogen.link import NoReplyError
    from protogen.link.counts import name_of

    if wait.expect not in {kind.NAME for kind in link.kinds}:
        names = ", ".join(kind.NAME for kind in link.kinds)
        raise UsageError(f"nobody else sends `{wait.expect}`", f"the other end sends {names}")
    seconds = _DEFAULT_TIMEOUT if wait.timeout is None else wait.timeout
    events, came = link.events(), Counter[str]()
    attempts = 1 + (wait.retries or 0)
    for _ in range(attempts):
        await link.send(given.record, **given.parts)
        try:
            async with asyncio.timeout(seconds):
                async for heard in events:
                    name = name_of(heard.event)
                    if name == wait.expect:
                        return heard.event
                    came[name] += 1
        except TimeoutError:
            continue
    raise link.told(NoReplyError(given.record, attempts, seconds, came))


def _print(codec: Codec, event: Any, format: str) -> None:
    from protogen.cli.wire.event_lines import EventLines, json_line

    if format == "jsonl":
        typer.echo(json_line(event))
        return
    lines = EventLines(codec.protocol, show_sender=False)
    # Where in the input it came says nothing here.
    typer.echo("".join(text for text, _ in lines.segments(event)[1:]).strip())
