"""Opens links: to a port by its address, as one endpoint of a protocol."""

from __future__ import annotations

import os
from collections.abc import Callable
from types import ModuleType, TracebackType
from typing import TYPE_CHECKING, Any, Generic, TypedDict, Unpack

from protogen.link.blocking import BlockingLink
from protogen.link.errors import LinkError
from protogen.link.line import LineDecoders
from protogen.link.link import Link, ReceivedT, SentT
from protogen.link.ports.lasting import LastingPort
from protogen.link.ports.opening import open_lasting_port, open_port
from protogen.link.ports.port import Port
from protogen.link.ports.settings import settings_of
from protogen.problems import hint_for
from protogen.runtime.codec import Protocol as Codec

if TYPE_CHECKING:
    from protogen.model.protocol import Protocol

MIN_SILENCE = 0.02
"""Seconds; adapters of USB keep bytes for up to 16 ms, so a shorter silence means nothing."""


class Options(TypedDict, total=False):
    """What may be said of a link beside its port and endpoint."""

    baud: int
    """Bits per second, in place of those of the schema."""
    dtr: bool | None
    """State of DTR; None, which is the default, leaves it as it is."""
    rts: bool | None
    peer: str
    """The endpoint whose bytes come in, where there are more than two."""
    silence: float | None
    """Seconds without bytes that end what has come, in place of those of the schema."""
    lasting: bool
    """False: a port that is lost is not opened again."""
    tell: Callable[[str], None]
    """Takes the news that the port was lost, or is back."""


class Connection(Generic[SentT, ReceivedT]):
    """A link that is not open yet: `async with` gives a Link, `with` a BlockingLink."""

    def __init__(
        self,
        codec: Codec[Any, Any],
        port: str | os.PathLike[str] | Port,
        endpoint: str | None,
        encode: Callable[..., bytes] | None,
        options: Options,
    ) -> None:
        self._codec = codec
        self._port = port if isinstance(port, Port) else os.fspath(port)
        self._endpoint = endpoint
        self._encode = encode
        self._options = options
        # What is wrong is told before a port is opened.
        _check(options)
        _decoders(codec, endpoint, options)
        self._link: Link[SentT, ReceivedT] | None = None
        self._blocking: BlockingLink[SentT, ReceivedT] | None = None

    async def open(self) -> Link[SentT, ReceivedT]:
        """Open the port, and begin to read. Raises PortError."""
        decoders = _decoders(self._codec, self._endpoint, self._options)
        decoders.prepare()  # Before bytes come in.
        port = self._port if isinstance(self._port, Port) else await self._opened(self._port)
        link = Link[SentT, ReceivedT](self._codec, port, self._endpoint, decoders, self._encode)
        self._link = link
        return link

    async def _opened(self, address: str) -> Port:
        options = self._options
        settings = settings_of(
            self._codec.line,
            options.get("baud"),
            dtr=options.get("dtr"),
            rts=options.get("rts"),
        )
        if not options.get("lasting", True):
            return await open_port(address, settings)
        return await open_lasting_port(address, settings, self._take_news)

    def _take_news(self, news: str) -> None:
        port = None if self._link is None else self._link.port
        if self._link is not None and isinstance(port, LastingPort) and not port.is_there:
            self._link.note_loss(news)
        tell = self._options.get("tell")
        if tell is not None:
            tell(news)

    async def __aenter__(self) -> Link[SentT, ReceivedT]:
        return await self.open()

    async def __aexit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        if self._link is not None:
            await self._link.close()

    def __enter__(self) -> BlockingLink[SentT, ReceivedT]:
        self._blocking = BlockingLink(self.open)
        return self._blocking

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        if self._blocking is not None:
            self._blocking.close()


def connect(
    codec: ModuleType | Codec[Any, Any] | Protocol,
    port: str | os.PathLike[str] | Port,
    endpoint: str | None = None,
    *,
    encode: Callable[..., bytes] | None = None,
    **options: Unpack[Options],
) -> Connection[Any, Any]:
    """Prepare a link to a port, which is opened by `async with`, or by `with`.

    `codec` is a generated module, or the protocol that `protogen.load` gives. `endpoint` is this
    program; what the others send is decoded. Without one, the link only listens. Raises LinkError
    where the protocol has no such endpoint, or an option is wrong.
    """
    if isinstance(codec, Codec):
        return Connection(codec, port, endpoint, encode, options)
    module: Any = codec if isinstance(codec, ModuleType) else _module_of(codec)
    if not isinstance(module.PROTOCOL, Codec):
        problem = f"{module.__name__} carries a runtime of its own along"
        raise LinkError(problem, "generate it without --standalone")
    return Connection(module.PROTOCOL, port, endpoint, module.encode, options)


def _check(options: Options) -> None:
    """Raise LinkError for an option that is none, or that has a value that can't be."""
    known = Options.__annotations__
    for name in options:
        if name not in known:
            hint = hint_for(name, known) or f"options are {', '.join(known)}"
            raise LinkError(f"`connect` has no option `{name}`", hint)
    baud, silence = options.get("baud"), options.get("silence")
    if baud is not None and (not isinstance(baud, int) or baud < 1):
        raise LinkError(f"{baud!r} is no baud rate", "give bits per second, such as 115200")
    if silence is not None and not silence >= 0:
        raise LinkError(f"{silence!r} is no silence", "give seconds, or None")


def _module_of(protocol: Protocol) -> ModuleType:
    from protogen.live.codec import kept_module

    return kept_module(protocol)


def _decoders(codec: Codec[Any, Any], endpoint: str | None, options: Options) -> LineDecoders:
    """The decoders of what the others send. Raises LinkError where there is no such endpoint."""
    for name in filter(None, (endpoint, options.get("peer"))):
        if name not in codec.line.endpoints:
            known = ", ".join(codec.line.endpoints)
            raise LinkError(f"{codec.name} has no endpoint {name!r}", f"there are {known}")
    peers = [name for name in codec.endpoints if name != endpoint]
    if "peer" in options:
        peers = [name for name in peers if name == options["peer"]]
    if not peers:
        alone = options.get("peer") or f"no other endpoint than {endpoint}"
        raise LinkError(f"{alone} sends nothing", "choose another endpoint")
    silence = options.get("silence", codec.line.silence)
    decoders = LineDecoders(codec, peers, None if silence is None else max(silence, MIN_SILENCE))
    if len(peers) > 1:
        try:
            decoders.feed("", b"")
        except ValueError as error:
            raise LinkError(str(error), f"give peer={' or '.join(map(repr, peers))}") from None
    return decoders
