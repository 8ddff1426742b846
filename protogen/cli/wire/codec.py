"""The codec that commands use: the Python target's own output for a schema."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import msgspec

from protogen.cli.exits import UsageError
from protogen.cli.schemas import compile_schema, find_senders, open_protocol, protocol_of
from protogen.schema.files import schema_path

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
        return self.protocol.sending

    def decoder(self, sender: str | None, told: Sequence[str] | None = None) -> Decoder[Any, Any]:
        """Return a new decoder of what ``sender`` sends; without one, of what all endpoints do.

        ``told`` are values of identities that are not sent, as PART=NUMBER. Raises UsageError where
        one decoder can't take the frames of all of them, or can't be told so.
        """
        from protogen.runtime.decoder import Decoder

        if sender is not None:
            find_senders(self.protocol, sender)
        try:
            decoder = Decoder(self.runtime.forms(sender))
        except ValueError as error:
            raise UsageError(str(error), f"give --sender {' or '.join(self.senders)}") from None
        for item in told or ():
            tell(decoder, item)
        return decoder


def tell(decoder: Decoder[Any, Any], written: str) -> None:
    """Tell a decoder PART=NUMBER, or PART=NUMBER,NUMBER for frames that follow each other.

    Raises UsageError.
    """
    name, is_there, numbers = written.partition("=")
    try:
        values = [int(number, 0) for number in numbers.split(",")] if is_there else []
    except ValueError:
        values = []
    if not values:
        raise UsageError(f"--told {written}: expected PART=NUMBER, or several with commas")
    try:
        decoder.tell(**{name: values})
    except ValueError as error:
        raise UsageError(f"--told {written}: {error}") from None


def open_codec(schema: Path) -> Codec:
    """Open the codec of a schema, kept or compiled. With an error in it, ends the command."""
    from protogen.live import cache
    from protogen.live.modules import import_modules

    schema = schema_path(schema)
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
