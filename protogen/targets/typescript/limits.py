"""What the target can't print yet."""

from __future__ import annotations

from collections.abc import Iterator

from protogen.errors import UserError
from protogen.model.protocol import Protocol

HINT = "leave the target out: `protogen generate --target`, or `targets` in protogen.toml"


def refuse(protocol: Protocol) -> None:
    """Raise UserError for the first thing that the runtime can't do."""
    for reason in _reasons(protocol):
        raise UserError(f"the target typescript can't print {protocol.name}: {reason}", HINT)


def _reasons(protocol: Protocol) -> Iterator[str]:
    for message in protocol.messages:
        for field in message.held:
            what = f"field {field.name} of {message.name}, which is a part of the frame"
            yield f"its payloads hold no numbers of frames, as {what}"
