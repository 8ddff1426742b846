"""A command that says in our words what is wrong with an option."""

from __future__ import annotations

import re
from typing import Any

import typer
from typer.core import TyperCommand

_VALIDATOR = "Value error, "
"""Prefix of the messages of the library behind typer; it tells a user nothing."""
_CHOICE = re.compile(r"(?P<given>'[^']*') is not one of (?P<choices>.*)\.")


class Command(TyperCommand):
    """A sub-command."""

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """Read the arguments. Raises BadParameter with what was probably meant."""
        try:
            return super().parse_args(ctx, args)
        except typer.BadParameter as error:
            error.message = in_our_words(error.message)
            raise


def in_our_words(message: str) -> str:
    """Return the message without the validator's words, with a suggestion if there is one."""
    from protogen.problems import hint_for

    plain = message.removeprefix(_VALIDATOR)
    found = _CHOICE.fullmatch(plain)
    if found is None:
        return plain
    hint = hint_for(found["given"].strip("'"), re.findall(r"'([^']*)'", found["choices"]))
    return f"{plain[:-1]}; {hint}" if hint else plain
