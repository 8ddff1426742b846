"""Rows as JSON by UDP, a datagram for each, as PlotJuggler's UDP server takes them."""

from __future__ import annotations

import socket
from collections.abc import Mapping
from typing import Any

from protogen.convert.columns.python_values import present_json
from protogen.errors import UserError
from protogen.serving.live_rows import LiveRow

Paths = Mapping[str, tuple[str, ...]]
"""Where the values of a row's columns stand in a datagram."""

_SECOND = 10**9


class DatagramSender:
    """Sends rows to an address. Whether somebody takes them is not known."""

    def __init__(self, host: str, port: int) -> None:
        """Raise UserError where there is no such host."""
        try:
            found = socket.getaddrinfo(host, port, type=socket.SOCK_DGRAM)
        except (OSError, UnicodeError, OverflowError) as error:
            problem = f"{host}:{port} is no address: {error}"
            raise UserError(problem, "PlotJuggler listens at 127.0.0.1:9870") from None
        family, kind, _, _, address = found[0]
        self._address: Any = address
        self._socket = socket.socket(family, kind)
        self._socket.setblocking(False)
        self._paths: dict[tuple[str, ...], Paths] = {}
        self.lost = 0
        """Rows that were too large for a datagram, or for which there was no room."""

    def send(self, row: LiveRow) -> None:
        """Send a row, if it fits."""
        paths = self._paths.get(row.topic.path)
        if paths is None:
            paths = self._paths[row.topic.path] = _paths_of(row)
        try:
            self._socket.sendto(_datagram(row, paths), self._address)
        except ConnectionRefusedError:
            pass  # Nobody listened to an earlier one.
        except OSError:
            self.lost += 1

    def stop(self) -> None:
        """Send no more."""
        self._socket.close()


def _paths_of(row: LiveRow) -> Paths:
    """Where each value stands: `pose.x` is the member `x` of `pose`. The time stands outside."""
    names = [name for name in row.values if name != "t_ns"]
    groups = {name[:end] for name in names for end, letter in enumerate(name) if letter == "."}
    # Beside a struct `turn_deg` there may be the physical values of a field `turn`.
    shown = {name: f"{name}_value" if name in groups else name for name in names}
    return {name: (*row.topic.path, *text.split(".")) for name, text in shown.items()}


def _datagram(row: LiveRow, paths: Paths) -> bytes:
    """JSON of a row, with `timestamp` in seconds; what has no value is left out."""
    tree: dict[str, Any] = {"timestamp": row.when / _SECOND}
    for name, (*outer, last) in paths.items():
        if row.values[name] is not None:
            place = tree
            for step in outer:
                place = place.setdefault(step, {})
            place[last] = row.values[name]
    return present_json(tree).encode()
