"""A server of Foxglove's WebSocket protocol: a channel for each topic, and messages to send.

Its subprotocol is `foxglove.sdk.v1`. The server runs in threads of the SDK.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any

import foxglove
from foxglove.websocket import Capability, ChannelView, Client, ClientChannel, StatusLevel

from protogen.convert.writers.mcap_json import JsonMessages
from protogen.errors import UserError
from protogen.serving.live_rows import LiveRow, Topic

_BACKLOG = 10_000
"""Messages that wait for a client that is slow; then the oldest are left out."""

Publish = Callable[[str, bytes], None]
"""Takes the topic and the data of a message that a client has published."""


class FoxgloveServer:
    """Serves topics to any number of clients."""

    def __init__(
        self,
        name: str,
        topics: Iterable[Topic],
        address: tuple[str, int],
        publish: Publish,
        subscribed: Callable[[], None],
    ) -> None:
        """`publish` and `subscribed` are called in other threads.

        Raises UserError where the address can't be served at.
        """
        # Channels are closed with the last reference to their context.
        self._context = context = foxglove.Context()
        encoding = JsonMessages()
        self._channels: dict[tuple[str, ...], foxglove.Channel] = {}
        self._encoders = {topic.path: encoding.encoder(topic.table) for topic in topics}
        for topic in topics:
            schema, text = encoding.schema(topic.table)
            self._channels[topic.path] = foxglove.Channel(
                topic.name,
                schema=foxglove.Schema(name=schema, encoding=encoding.schema_encoding, data=text),
                message_encoding=encoding.message_encoding,
                metadata=dict(topic.table.facts),
                context=context,
            )
        self._problems: set[str] = set()
        host, port = address
        try:
            self._server = foxglove.start_server(
                name=name,
                host=host,
                port=port,
                capabilities=[Capability.ClientPublish],
                supported_encodings=[encoding.message_encoding],
                server_listener=_Clients(publish, subscribed, self.complain),
                context=context,
                message_backlog_size=_BACKLOG,
            )
        except RuntimeError as error:
            problem = f"{host}:{port} can't be served at: {error}"
            raise UserError(problem, "choose --host and --port") from None
        self.address = f"ws://{host}:{self._server.port}"

    def send(self, row: LiveRow) -> None:
        """Send a row to the clients that have subscribed to its topic."""
        channel = self._channels[row.topic.path]
        if channel.has_sinks():
            data = self._encoders[row.topic.path](row.values)
            channel.log(data, log_time=max(0, row.when))

    def complain(self, topic: str, problem: str) -> None:
        """Tell all clients what is wrong with what was published on a topic."""
        self._problems.add(topic)
        self._server.publish_status(f"{topic}: {problem}", StatusLevel.Error, topic)

    def settle(self, topic: str) -> None:
        """Take back what was told of a topic: something right was published there."""
        if topic in self._problems:
            self._problems.discard(topic)
            self._server.remove_status([topic])

    def note(self, text: str) -> None:
        """Tell all clients news of the line."""
        self._server.publish_status(text, StatusLevel.Warning)

    def stop(self) -> None:
        """Let all clients go."""
        self._server.stop()


class _Clients:
    """What clients do; the SDK asks for each of these methods."""

    def __init__(
        self,
        publish: Publish,
        subscribed: Callable[[], None],
        complain: Callable[[str, str], None],
    ) -> None:
        self._publish = publish
        self._subscribed = subscribed
        self._complain = complain
        self._channels: dict[tuple[int, int], ClientChannel] = {}

    def on_subscribe(self, client: Client, channel: ChannelView) -> None:
        self._subscribed()

    def on_unsubscribe(self, client: Client, channel: ChannelView) -> None:
        pass

    def on_client_advertise(self, client: Client, channel: ClientChannel) -> None:
        self._channels[client.id, channel.id] = channel

    def on_client_unadvertise(self, client: Client, client_channel_id: int) -> None:
        self._channels.pop((client.id, client_channel_id), None)

    def on_message_data(self, client: Client, client_channel_id: int, data: bytes) -> None:
        channel = self._channels.get((client.id, client_channel_id))
        if channel is None:
            return
        if channel.encoding != "json":
            self._complain(channel.topic, f"is published as {channel.encoding}; publish JSON")
            return
        self._publish(channel.topic, data)

    def __getattr__(self, name: str) -> Any:
        if name.startswith("on_"):  # What a later SDK may tell, too.
            return lambda *args: None
        raise AttributeError(name)
