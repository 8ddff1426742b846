"""What can go wrong on a link, told with what came instead and what to do."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from typing import Any

from protogen.errors import UserError
from protogen.runtime.attributes import attribute
from protogen.runtime.payload.message import Message


class LinkError(UserError):
    """A link can't do what it was asked for."""


class LinkClosedError(LinkError):
    """The link was closed, or its input has ended."""


class RefusedError(LinkError):
    """A request was refused; `refusal` is the message that says so."""

    def __init__(self, request: Message, refusal: Message) -> None:
        super().__init__(f"{type(request).NAME} was refused: {_shown(refusal)}")
        self.request = request
        self.refusal = refusal


class NoReplyError(LinkError):
    """Nothing answered a request in time; `came` counts what came meanwhile."""

    def __init__(
        self, request: Message, attempts: int, timeout: float, came: Mapping[str, int]
    ) -> None:
        name = type(request).NAME
        times = "once" if attempts == 1 else f"{attempts} times"
        waited = f"waited {timeout:g} s" if attempts == 1 else f"waited {timeout:g} s each time"
        if attempts:
            super().__init__(
                f"no reply to {name}, sent {times}, {waited}: {_listed(came)}", _hint(came)
            )
        else:
            super().__init__(f"{name} was not sent: the port did not take it in time", _FULL)
        self.request = request
        self.attempts = attempts
        """How often it was sent; not at all, where the port took nothing for so long."""
        self.timeout = timeout
        self.came = Counter(came)
        """Messages by name, `unknown`, and invalid bytes by reason, as `invalid: checksum`."""


_FULL = "does the other end read, or does its flow control hold the line back?"


def _shown(message: Message) -> str:
    name = type(message).NAME
    shown = message.to_dict().items()
    fields = ", ".join(f"{key}={_label(message, key, value)}" for key, value in shown)
    return f"{name} ({fields})" if fields else name


def _label(message: Message, name: str, value: Any) -> str:
    """A value by its name, where it has one."""
    label = getattr(getattr(message, attribute(name), None), "name", None)
    return label.lower() if isinstance(label, str) else repr(value)


def _listed(came: Mapping[str, int]) -> str:
    if not came:
        return "nothing came at all"
    listed = (f"{number} x {name}" for name, number in came.items())
    return f"instead came {', '.join(listed)}"


def _hint(came: Mapping[str, int]) -> str:
    if not came:
        return "is it the right port, does the device have power, and is it to answer?"
    if all(name.startswith("invalid") for name in came):
        return "nothing was readable: do the baud rate and the schema fit the device?"
    if set(came) == {"unknown"}:
        return "the schema has none of these messages: is it of that device, and the sender right?"
    return "a longer `timeout`, or `retries`, in the exchange or where the request is made"
