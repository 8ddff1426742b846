"""Answers of a simulated device: what the exchanges say, refused or left out on purpose."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from random import Random
from typing import Any

import msgspec

from protogen.link.simulated_values import Values
from protogen.model.messages import Exchange
from protogen.model.protocol import Protocol
from protogen.runtime.errors import EncodeError

Answer = Callable[[Any], Iterable[Any]]
"""Messages that answer an event: each a message, or a pair of one and its parts."""
Make = Callable[[str, Mapping[str, Any]], tuple[Any, Values]]
"""Makes a message, and its parts, where some fields or parts have to have these values."""


class AnswerRates(msgspec.Struct, frozen=True, kw_only=True):
    """How many requests are not answered as they should; none, if nothing is said."""

    refuse: float = 0.0
    """Share of requests that are refused, where their exchange has a refusal, from 0 to 1."""
    ignore: float = 0.0
    """Share of requests that nothing answers, from 0 to 1."""


class _Choices(msgspec.Struct, frozen=True):
    """What an endpoint can answer to a request."""

    exchange: Exchange
    replies: tuple[str, ...]
    refusals: tuple[str, ...]


class ExchangeAnswers:
    """Answers of one endpoint to the requests of the schema's exchanges."""

    def __init__(
        self, protocol: Protocol, endpoint: str, make: Make, rates: AnswerRates, seed: int
    ) -> None:
        self._make = make
        self._rates = rates
        self._random = Random(f"{seed} answers")  # noqa: S311 - nothing here is secret
        self._choices = dict(_choices(protocol, endpoint))

    @property
    def requests(self) -> tuple[str, ...]:
        """The messages that are answered."""
        return tuple(self._choices)

    def __call__(self, event: Any) -> Iterator[tuple[Any, Values]]:
        """Yield the first answer that can have what the request has; none if it is ignored."""
        choices = self._choices[event.message.NAME]
        chance = self._random.random()
        if chance < self._rates.ignore:
            return
        is_refused = chance < self._rates.ignore + self._rates.refuse and choices.refusals
        names = choices.refusals if is_refused else choices.replies
        pairs = _pairs(choices.exchange, event)
        if is_refused and not choices.exchange.is_refusal_matched:
            pairs = {}
        for name in names:
            try:
                made = self._make(name, pairs)
            except EncodeError:
                continue
            yield made
            return


def can_refuse(protocol: Protocol, endpoint: str) -> bool:
    """True if an endpoint sends a refusal of some request."""
    return any(choices.refusals for _, choices in _choices(protocol, endpoint))


def _choices(protocol: Protocol, endpoint: str) -> Iterator[tuple[str, _Choices]]:
    """Yield the requests that an endpoint answers."""
    sent = {message.name for message in protocol.messages if endpoint in message.senders}
    for exchange in protocol.exchanges:
        replies = tuple(name for name in exchange.replies if name in sent)
        refusals = tuple(name for name in exchange.refusals if name in sent)
        for request in exchange.requests if replies else ():
            yield request, _Choices(exchange, replies, refusals)


def _pairs(exchange: Exchange, event: Any) -> dict[str, Any]:
    """What an answer has of its request, by the answer's names, as lines of JSON have it."""
    if not exchange.match:
        return {}
    line = event.as_json()
    shown = {**line["parts"], **line["fields"]}
    return {answer: shown[asked] for asked, answer in exchange.match}
