"""Frames of what is typed in the monitor."""

from __future__ import annotations

import shlex
from typing import TYPE_CHECKING

from protogen.cli.wire.given import given_message
from protogen.errors import UserError

if TYPE_CHECKING:
    from protogen.cli.wire.codec import Codec


def frame_of(codec: Codec, text: str) -> bytes:
    """The frame of `MESSAGE FIELD=VALUE @PART=VALUE`. Raises UserError."""
    try:
        words = shlex.split(text)
    except ValueError as error:
        raise UserError(f"`{text}`: {error}") from None
    if not words:
        raise UserError("no message is named", "write MESSAGE FIELD=VALUE ...")
    return given_message(codec, words[0], words[1:], None, None).frame()
