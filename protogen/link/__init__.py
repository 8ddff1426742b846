"""The live line: typed streams and requests over a port, which is opened by its address."""

from typing import TYPE_CHECKING

from protogen.runtime.lazy import importer

__all__ = [
    "BlockingLink",
    "BlockingStream",
    "Connection",
    "Heard",
    "Link",
    "LinkClosedError",
    "LinkCounts",
    "LinkError",
    "NoReplyError",
    "Options",
    "PortError",
    "PortLostError",
    "RefusedError",
    "Stream",
    "connect",
]

if TYPE_CHECKING:
    from protogen.link.blocking import BlockingLink, BlockingStream
    from protogen.link.connection import Connection, Options, connect
    from protogen.link.counts import LinkCounts
    from protogen.link.errors import LinkClosedError, LinkError, NoReplyError, RefusedError
    from protogen.link.link import Link
    from protogen.link.ports.port import PortError, PortLostError
    from protogen.link.streams import Heard, Stream
else:
    # Commands that need only a part of it start sooner.
    __getattr__ = importer(
        globals(),
        {
            ".blocking": ("BlockingLink", "BlockingStream"),
            ".connection": ("Connection", "Options", "connect"),
            ".counts": ("LinkCounts",),
            ".errors": ("LinkClosedError", "LinkError", "NoReplyError", "RefusedError"),
            ".link": ("Link",),
            ".ports.port": ("PortError", "PortLostError"),
            ".streams": ("Heard", "Stream"),
        },
    )
