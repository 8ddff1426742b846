"""What a module says of its line: settings, and which message answers which."""

from __future__ import annotations

from protogen.runtime.payload.message import Message
from protogen.runtime.values import Frozen


class Line(Frozen):
    """Settings of a line, and the endpoints on it."""

    __slots__ = ("baud", "data_bits", "endpoints", "parity", "silence", "stop_bits")

    endpoints: tuple[str, ...]
    """All endpoints, also those that send nothing."""
    baud: int | None
    """Bits per second; None where the schema does not say."""
    data_bits: int
    parity: str
    stop_bits: int
    silence: float | None
    """Seconds without bytes that end what a decoder holds; None: they never do."""

    def __init__(
        self,
        endpoints: tuple[str, ...],
        *,
        baud: int | None = None,
        data_bits: int = 8,
        parity: str = "none",
        stop_bits: int = 1,
        silence: float | None = None,
    ) -> None:
        self._set(endpoints, baud, data_bits, parity, stop_bits, silence)


class Exchange(Frozen):
    """Requests, and the messages that answer them."""

    __slots__ = (
        "is_refusal_matched",
        "match",
        "name",
        "refusals",
        "replies",
        "requests",
        "retries",
        "timeout",
    )

    name: str
    requests: tuple[type[Message], ...]
    """The messages that ask."""
    replies: tuple[type[Message], ...]
    """Those of which any settles a request."""
    refusals: tuple[type[Message], ...]
    """Those of which any refuses it."""
    match: tuple[tuple[str, str], ...]
    """Fields or parts of the request and of its reply that are equal; without any, order decides.
    """
    is_refusal_matched: bool
    """False if a refusal does not say of which request it is."""
    timeout: float | None
    """Seconds after which a request is lost; None where the schema does not say."""
    retries: int
    """How often a request is then sent again."""

    def __init__(  # noqa: PLR0913 - an argument for each field
        self,
        name: str,
        *,
        requests: tuple[type[Message], ...],
        replies: tuple[type[Message], ...],
        refusals: tuple[type[Message], ...] = (),
        match: tuple[tuple[str, str], ...] = (),
        is_refusal_matched: bool = True,
        timeout: float | None = None,
        retries: int = 0,
    ) -> None:
        self._set(name, requests, replies, refusals, match, is_refusal_matched, timeout, retries)
