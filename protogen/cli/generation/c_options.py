"""The options of `protogen generate` that shape generated C."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Annotated, TypeVar

import msgspec
import typer

from protogen.cli.exits import UsageError

if TYPE_CHECKING:
    from protogen.model.protocol import Protocol
    from protogen.targets.output import File

NAME = "c"
_Word = TypeVar("_Word", bound=str)

Style = Annotated[
    str | None,
    typer.Option(
        "--c-style",
        metavar="split|single",
        help="A header and a source, or one header that holds both. Default: split.",
    ),
]
Events = Annotated[
    str | None,
    typer.Option(
        "--events",
        metavar="all|messages",
        help="messages: C decoders leave invalid and unknown frames out. Default: all.",
    ),
]
Only = Annotated[
    list[str] | None,
    typer.Option("--only", metavar="MESSAGE", help="C for this message only; may be repeated."),
]
Senders = Annotated[
    list[str] | None,
    typer.Option("--sender", metavar="NAME", help="C for what this endpoint sends; repeatable."),
]
Stubs = Annotated[
    bool | None,
    typer.Option(
        "--c-stubs/--no-c-stubs",
        help="NAME_stubs.c with empty handlers, where there is none yet.",
        show_default=False,
    ),
]

Hpp = Annotated[
    bool | None,
    typer.Option(
        "--c-hpp/--no-c-hpp",
        help="NAME.hpp, the same for C++, over the header of C.",
        show_default=False,
    ),
]


class Choice(msgspec.Struct, frozen=True):
    """Options of the command line about C; None where it said nothing."""

    style: str | None
    events: str | None
    only: Sequence[str] | None
    senders: Sequence[str] | None
    stubs: bool | None
    hpp: bool | None

    @property
    def is_default(self) -> bool:
        """True if nothing was said."""
        flags = (self.stubs, self.hpp)
        return not any((self.style, self.events, self.only, self.senders, *flags))


class ChosenC(msgspec.Struct, frozen=True):
    """The C target, with what the command line said."""

    choice: Choice
    name: str = NAME
    folder: str = NAME

    def emit(self, protocols: Sequence[Protocol]) -> tuple[File, ...]:
        """Return the files for these protocols. Raises UsageError where a name is unknown."""
        from protogen.cli.schemas import check_known
        from protogen.targets.c.emit import emit
        from protogen.targets.c.options import EVENTS, STYLES, COptions

        choice = self.choice
        for protocol in protocols:
            messages = [message.name for message in protocol.messages]
            check_known("message", choice.only, messages, protocol.name)
            senders = [sender.name for sender in protocol.senders]
            check_known("sender", choice.senders, senders, protocol.name)
        options = COptions(
            style=_one_of("--c-style", choice.style, STYLES),
            events=_one_of("--events", choice.events, EVENTS),
            only=tuple(choice.only) if choice.only else None,
            senders=tuple(choice.senders) if choice.senders else None,
            stubs=bool(choice.stubs),
            hpp=bool(choice.hpp),
        )
        return emit(protocols, options)


def _one_of(option: str, given: str | None, allowed: tuple[_Word, ...]) -> _Word:
    from protogen.problems import hint_for

    if given is None:
        return allowed[0]
    for choice in allowed:
        if choice == given:
            return choice
    message = f"{option} is {' or '.join(allowed)}, not `{given}`"
    raise UsageError(message, hint_for(given, allowed))
