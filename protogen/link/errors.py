"""What can go wrong on a link, told with what came instead and what to do."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping

from protogen.errors import UserError
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
        times = "once" if attempts == 1 else f"{attempts} times"
        waited = f"waited {timeout:g} s" if attempts == 1 else f"waited {timeout:g} s each time"
        problem = f"no reply to {type(request).NAME}, sent {times}, {waited}: {_listed(came)}"
        super().__init__(problem, _hint(came))
        self.request = request
        self.attempts = attempts
        self.timeout = timeout
        self.came = Counter(came)
        """Messages by name, `unknown`, and invalid bytes by reason, as `invalid: checksum`."""


def _shown(message: Message) -> str:
    name = type(message).NAME
    fields = ", ".join(f"{key}={value!r}" for key, value in message.to_dict().items())
    return f"{name} ({fields})" if fields else name


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
    return "a longer `timeout`, or `retries`, in the exchange or where the request is made"
