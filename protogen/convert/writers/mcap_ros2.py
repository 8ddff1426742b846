"""Messages of MCAP that are those of ROS 2, as its bags have them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from protogen.convert.columns.tables import Table, Tables
from protogen.convert.ros2.cdr import encoder_of
from protogen.convert.ros2.definition import definition_of
from protogen.convert.ros2.layout import Layout


class Ros2Messages:
    """The encoding of messages as ROS 2 transports them."""

    profile = "ros2"
    compression = ""
    has_checksums = False
    schema_encoding = "ros2msg"
    message_encoding = "cdr"

    def __init__(self, tables: Tables) -> None:
        self._layout = Layout(tables)

    def schema(self, table: Table) -> tuple[str, bytes]:
        """The type of a table's messages, and its definition."""
        message, package = self._layout.messages[table.name], self._layout.package
        return f"{package}/msg/{message.name}", definition_of(message, package).encode()

    def encoder(self, table: Table) -> Callable[[Mapping[str, Any]], bytes]:
        """What makes messages of rows: values by the names of their columns."""
        return encoder_of(self._layout.messages[table.name])
