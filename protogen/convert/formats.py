"""Formats of captures and of tables, as the command line names them.

Nothing else is imported here, because every command does it at its start.
"""

from __future__ import annotations

from enum import StrEnum


class InputKind(StrEnum):
    """Formats of the bytes of the line."""

    RAW = "raw"
    HEX = "hex"
    LOG = "log"
    RECORD = "record"


class OutputFormat(StrEnum):
    """Formats of tables."""

    JSONL = "jsonl"
    CSV = "csv"
    PARQUET = "parquet"
    ARROW = "arrow"
    MCAP = "mcap"
    MCAP_ROS2 = "mcap-ros2"

    @property
    def is_printed(self) -> bool:
        """True if rows are printed as text or bytes one by one, not made of columns."""
        return self not in (OutputFormat.PARQUET, OutputFormat.ARROW)
