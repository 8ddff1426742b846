"""Captures as columns: the events of a whole stream in NumPy tables, one for each message.

    from protogen.capture import batches, columns

    tables = columns("run.bin", "rflex", sender="flex")
    tables.messages["read_motor"]["velocity"]        # raw values of every such message
    for tables in batches("run.bin", "rflex", sender="flex"):
        ...                                          # the same rows in constant memory

Needs NumPy: `pip install 'protogen-serial[capture]'`.
"""

from __future__ import annotations

from protogen.capture.errors import (
    CaptureError,
    MissingPackageError,
    NoSilenceWarning,
    SlowCaptureWarning,
)
from protogen.capture.read import batches, columns
from protogen.capture.schema import CaptureSchema, Column, InvalidReason, TableSchema
from protogen.capture.tables import Tables

__all__ = [
    "CaptureError",
    "CaptureSchema",
    "Column",
    "InvalidReason",
    "MissingPackageError",
    "NoSilenceWarning",
    "SlowCaptureWarning",
    "TableSchema",
    "Tables",
    "batches",
    "columns",
]
