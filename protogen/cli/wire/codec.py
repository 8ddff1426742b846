"""The codec that commands use: the Python target's own output for a schema."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import msgspec

from protogen.cli.exits import UsageError
from protogen.cli.schemas import compile_schema, find_sender, open_protocol, protocol_of

if TYPE_CHECKING:
    from types import ModuleType

    from protogen.model.protocol import Protocol
    from protogen.runtime.codec import Protocol as RuntimeProtocol
    from protogen.runtime.decoder import Decoder


class Codec(msgspec.Struct, frozen=True):
    """A protocol, and what the module that would be generated for it makes of it."""

    protocol: Protocol
    module: ModuleType

    @property
    def runtime(self) -> RuntimeProtocol[Any, Any]:
        """The module's `PROTOCOL`."""
        runtime: RuntimeProtocol[Any, Any] = self.module.PROTOCOL
        return runtime

    @property
    def senders(self) -> tuple[str, ...]:
        """The endpoints that send something."""
        return tuple(sender.name for sender in self.protocol.senders)

    def sender_of_bytes(self, name: str | None) -> str:
        """Return who sent the bytes: the endpoint of that name, or the only one that sends.

        Raises UsageError if that is not clear.
        """
        if name is not None:
            return find_sender(self.protocol, name).name
        if len(self.senders) == 1:
            return self.senders[0]
        raise self._unclear("nothing says who sent the bytes")

    def sender_of_frames(self, name: str | None, data: bytes) -> str:
        """Return who sent these bytes: as `sender_of_bytes`, or the only one who can have.

        That is one whose frames are all of the bytes, while no other's are any of them. Raises
        UsageError if that is not clear.
        """
        if name is not None or len(self.senders) == 1 or not data:
            return self.sender_of_bytes(name)
        kinds = {sender: self._kinds(sender, data) for sender in self.senders}
        found = [sender for sender, seen in kinds.items() if "message" in seen]
        if len(found) == 1 and kinds[found[0]] == {"message"}:
            return found[0]
        both = f": they are frames of {' and of '.join(found)}" if len(found) > 1 else ""
        raise self._unclear(f"nothing says who sent the bytes{both}")

    def _kinds(self, sender: str, data: bytes) -> set[str]:
        decoder = self.decoder(sender)
        return {event.kind for event in (*decoder.feed(data), *decoder.flush())}

    def _unclear(self, message: str) -> UsageError:
        return UsageError(message, f"give --sender {' or '.join(self.senders)}")

    def decoder(self, sender: str) -> Decoder[Any, Any]:
        """Return a new decoder of what ``sender`` sends."""
        from protogen.runtime.decoder import Decoder

        return Decoder(self.runtime.sender(sender))


def open_codec(schema: Path) -> Codec:
    """Open the codec of a schema, kept or compiled. With an error in it, ends the command."""
    from protogen.live import cache
    from protogen.live.modules import import_modules

    compiled = cache.read(schema)
    if compiled is None:
        from protogen.live.codec import modules_of

        compilation = compile_schema(schema)
        protocol = protocol_of(compilation)
        compiled = cache.Compiled(protocol, modules_of(protocol))
        cache.keep(schema, compilation.sources, compiled)
    return Codec(compiled.protocol, import_modules(compiled.modules))


def fresh_codec(schema: Path) -> Codec:
    """Compile a schema and import its codec, to try both. With an error in it, ends the command."""
    from protogen.live import codec

    protocol = open_protocol(schema)
    return Codec(protocol, codec.module_of(protocol))
