"""What captures are written in, and what they are converted to, as the command line names it.

Nothing else is imported here, because every command does it at its start.
"""

from __future__ import annotations

from enum import StrEnum


class InputKind(StrEnum):
    """What the bytes of the line are written in."""

    RAW = "raw"
    HEX = "hex"
    LOG = "log"
    RECORD = "record"


class OutputFormat(StrEnum):
    """What tables are written as."""

    JSONL = "jsonl"
    CSV = "csv"
    PARQUET = "parquet"
    ARROW = "arrow"
    MCAP = "mcap"
