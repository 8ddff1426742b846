"""What the functions, types and macros of a decoder are called."""

from __future__ import annotations

import msgspec

from protogen.targets.c.spelling import Names


class NamedDecoder(msgspec.Struct, frozen=True):
    """Base of decoders: that of a sender's frames, and that of all forms of an endpoint's."""

    names: Names
    name: str

    @property
    def prefix(self) -> str:
        """Prefix of its functions and types."""
        return self.names.senders[self.name]

    @property
    def upper(self) -> str:
        """Prefix of its macros."""
        return self.prefix.upper()

    @property
    def protocol(self) -> str:
        """Prefix of the protocol's functions and types."""
        return self.names.prefix

    @property
    def protocol_upper(self) -> str:
        """Prefix of the protocol's macros."""
        return self.protocol.upper()
