"""What a generated module says of its line, and how it connects to one."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from fractions import Fraction

from protogen.copying import replace
from protogen.model.messages import Exchange
from protogen.model.protocol import Link, Protocol
from protogen.targets.python.literals import call, text, tuple_of
from protogen.targets.python.names import Names
from protogen.targets.python.wrapping import method, one_of

_PORT = "port: str | _Port"
_OPTIONS = "**options: _typing.Unpack[_Options]"


def line(protocol: Protocol) -> str:
    """The settings of the line, and the endpoints on it."""
    link, plain = protocol.link, Link()
    return call(
        "_rt.Line",
        tuple_of(text(endpoint.name) for endpoint in protocol.endpoints),
        baud=None if link.baud is None else str(link.baud),
        data_bits=None if link.data_bits == plain.data_bits else str(link.data_bits),
        parity=None if link.parity == plain.parity else text(link.parity),
        stop_bits=None if link.stop_bits == plain.stop_bits else str(link.stop_bits),
        silence=_seconds(protocol.silence),
    )


def requests_of(protocol: Protocol) -> Iterable[Exchange]:
    """The exchanges that are requests, with the messages that are there, as receivers take them."""
    there = {message.name: message for message in protocol.messages}

    def received(names: Sequence[str]) -> tuple[str, ...]:
        known = (there[name] for name in names if name in there)
        found = (
            sender.received_as(message.name)
            for message in known
            for sender in protocol.senders_of(message)
        )
        return tuple(dict.fromkeys(found))

    for item in protocol.exchanges:
        kept = replace(
            item,
            requests=tuple(name for name in item.requests if name in there),
            replies=received(item.replies),
            refusals=received(item.refusals),
        )
        if kept.requests and kept.replies:
            yield kept


def exchange(item: Exchange, protocol: Protocol, names: Names) -> str:
    """A request with what answers it."""
    return call(
        "_rt.Exchange",
        text(item.name),
        requests=_classes(item.requests, names),
        replies=_classes(item.replies, names),
        refusals=_classes(item.refusals, names) if item.refusals else None,
        match=tuple_of(tuple_of(map(text, pair)) for pair in item.match) if item.match else None,
        is_refusal_matched=None if item.is_refusal_matched else "False",
        timeout=_seconds(item.timeout),
        retries=str(item.retries) if item.retries else None,
    )


def _classes(messages: Sequence[str], names: Names) -> str:
    return tuple_of(names.types[message] for message in messages)


def _seconds(time: Fraction | None) -> str | None:
    return None if time is None else repr(float(time))


def connect_heads(protocol: Protocol, names: Names, any_message: str) -> tuple[str, ...]:
    """The heads of `connect`: as each endpoint, and as one who only listens."""
    heads = []
    for endpoint in protocol.endpoints:
        sent = names.unions.get(endpoint.name, "_typing.Never")
        others = [union for name, union in names.unions.items() if name != endpoint.name]
        received = one_of(others) if others else "_typing.Never"
        kind = f"_typing.Literal[{text(endpoint.name)}]"
        heads.append(_head(f"endpoint: {kind}", f"_Connection[{sent}, {received}]", ": ..."))
    alone = f"_Connection[_typing.Never, {any_message}]"
    return (*heads, _head("endpoint: None = None", alone, ": ..."))


def connect_head(protocol: Protocol) -> str:
    """The head of `connect` itself."""
    names = ", ".join(text(endpoint.name) for endpoint in protocol.endpoints)
    kind = f"endpoint: _typing.Literal[{names}] | None = None"
    return _head(kind, "_Connection[_typing.Any, _typing.Any]", ":")


def _head(endpoint: str, made: str, end: str) -> str:
    return method("def connect(", f"{_PORT}, {endpoint}, {_OPTIONS}", f") -> {made}{end}", 0)
