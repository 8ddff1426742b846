"""Frames of the messages that clients publish as JSON."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from protogen.cli.wire.given import given_message
from protogen.convert.columns.topics import topic_of
from protogen.errors import UserError
from protogen.runtime.codec import Encoder

if TYPE_CHECKING:
    from protogen.cli.wire.codec import Codec


class Publisher:
    """Makes frames as the endpoints that we are. Counters go on from frame to frame."""

    def __init__(self, codec: Codec, endpoints: Sequence[str]) -> None:
        self._codec = codec
        self._encoders = {name: Encoder(codec.runtime.forms(name)) for name in endpoints}

    @property
    def topics(self) -> tuple[str, ...]:
        """The topics on which may be published."""
        return tuple(
            topic_of(self._codec.protocol.name, message.endpoint, item.name)
            for name in self._encoders
            for message in self._codec.protocol.forms(name)
            for item in message.messages
        )

    def frame(self, topic: str, data: bytes) -> tuple[str, bytes]:
        """Who sends what is published on `/PROTOCOL/ENDPOINT/MESSAGE`, and its frame.

        Values may be written as on a command line: numbers, names, `"90deg"`; parts of the frame
        are members `@PART`. Raises UserError, which names the field.
        """
        endpoint, name = self._split(topic)
        written = [f"{key}={_text(value)}" for key, value in _object(data).items()]
        given = given_message(self._codec, name, written, endpoint, None)
        with given.explained():
            frame = self._encoders[endpoint].encode_next(given.record, strict=True, **given.parts)
        return endpoint, frame

    def _split(self, topic: str) -> tuple[str, str]:
        root, protocol, endpoint, name, *rest = [*topic.split("/"), *4 * [""]]
        if root or protocol != self._codec.protocol.name or not name or any(rest):
            raise UserError("is no topic to publish on", f"there are {', '.join(self.topics)}")
        if endpoint not in self._encoders:
            who = " or ".join(self._encoders) or "nobody"
            problem = f"what is published is sent as {who}, not as {endpoint}"
            raise UserError(problem, "say who sends it by `protogen serve --endpoint NAME`")
        return endpoint, name


def _object(data: bytes) -> Mapping[str, Any]:
    try:
        value = json.loads(data)
    except (ValueError, RecursionError) as error:
        raise UserError(f"this is not JSON: {error}") from None
    if not isinstance(value, dict):
        raise UserError("a message is an object of JSON", 'such as {"speed": 5}')
    return {name: item for name, item in value.items() if item is not None}


def _text(value: Any) -> str:
    """A value as it is written on a command line."""
    return value if isinstance(value, str) else json.dumps(value)
