"""Options of the C target."""

from __future__ import annotations

from typing import Literal, get_args

import msgspec

from protogen.model.messages import Message
from protogen.model.protocol import Protocol, Sender

Style = Literal["split", "single"]
Events = Literal["all", "messages"]
STYLES: tuple[Style, ...] = get_args(Style)
EVENTS: tuple[Events, ...] = get_args(Events)


class COptions(msgspec.Struct, frozen=True, kw_only=True):
    """Parts and style of what is printed. None stands for all of them."""

    style: Style = "split"
    """A header and a source, or one header that holds both."""
    events: Events = "all"
    """`messages`: the decoder leaves invalid and unknown frames out."""
    only: tuple[str, ...] | None = None
    """The messages to print."""
    senders: tuple[str, ...] | None = None
    """The endpoints, or single forms of them, whose messages are printed."""
    stubs: bool = False
    """True to make a source with an empty body for each handler, where there is none."""
    hpp: bool = False
    """True to make a header for C++, too."""

    def chosen(self, protocol: Protocol) -> tuple[Message, ...]:
        """The messages to print, in the schema's order."""
        taken = [sender for sender in protocol.senders if self.takes(sender)]
        return tuple(
            message
            for message in protocol.messages
            if (self.only is None or message.name in self.only)
            and any(sender.sends(message) for sender in taken)
        )

    def takes(self, sender: Sender) -> bool:
        """True if a sender's messages may be printed: its endpoint, or this form, is chosen."""
        return self.senders is None or not {sender.name, sender.endpoint}.isdisjoint(self.senders)
