"""The codec that commands use: the Python target's own output for a schema."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from protogen.cli.schemas import find_sender, open_protocol

if TYPE_CHECKING:
    from protogen.model.protocol import Protocol
    from protogen.runtime.codec import Protocol as RuntimeProtocol
    from protogen.runtime.decoder import Decoder


@dataclass(frozen=True, slots=True)
class Codec:
    """A protocol, and what the module that would be generated for it makes of it."""

    protocol: Protocol
    runtime: RuntimeProtocol[Any, Any]

    def decoder(self, sender: str) -> Decoder[Any, Any]:
        """Return a new decoder of what ``sender`` sends. Raises UsageError if it sends nothing."""
        from protogen.runtime.decoder import Decoder

        return Decoder(self.runtime.sender(find_sender(self.protocol, sender).name))


def open_codec(schema: Path) -> Codec:
    """Compile a schema and import its codec. With an error in it, ends the command."""
    from protogen.targets.python.live import module_of

    protocol = open_protocol(schema)
    return Codec(protocol, module_of(protocol).PROTOCOL)
