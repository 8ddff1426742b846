"""The C source that fills rows of one sender's messages, printed once for a model."""

from __future__ import annotations

from protogen.capture.layout import capture_schema
from protogen.model.protocol import Protocol, Sender
from protogen.native.driver import Driver
from protogen.targets.c.protocol_names import names_of
from protogen.targets.c.rows.layout import layout_of
from protogen.targets.c.rows.source import rows_source

_KEPT: dict[tuple[int, str], tuple[Protocol, Driver]] = {}
"""By the identity of the model, which stays what it is as long as it is kept here."""
_MOST_KEPT = 16


def driver_of(protocol: Protocol, sender: Sender) -> Driver:
    """The driver of what one endpoint sends."""
    key = id(protocol), sender.name
    if key not in _KEPT:
        while len(_KEPT) >= _MOST_KEPT:
            del _KEPT[next(iter(_KEPT))]
        _KEPT[key] = protocol, _driver(protocol, sender)
    return _KEPT[key][1]


def _driver(protocol: Protocol, sender: Sender) -> Driver:
    schema = capture_schema(protocol, sender)
    layout = layout_of(schema, names_of(protocol))
    return Driver(
        text=rows_source(protocol, sender, schema, tuple(layout)),
        schema=schema,
        layout=tuple(layout.values()),
        spells=not sender.plan.has_one_spelling,
    )
