"""The formats that captures are converted to."""

from __future__ import annotations

from collections.abc import Iterable
from contextlib import suppress
from typing import Protocol

from protogen.convert.columns.batches import Batch, Tally
from protogen.convert.columns.tables import Tables
from protogen.convert.errors import needed
from protogen.convert.formats import OutputFormat
from protogen.convert.writers.pending_files import Pending

_NEEDS = {
    OutputFormat.PARQUET: (("pyarrow", "numpy"), "writing Parquet"),
    OutputFormat.ARROW: (("pyarrow", "numpy"), "writing Arrow"),
    OutputFormat.MCAP: (("mcap",), "writing MCAP"),
    OutputFormat.MCAP_ROS2: (("mcap",), "writing MCAP"),
}
"""The packages that a format needs, and for what. PyArrow comes without NumPy."""


class Writer(Protocol):
    """Writes the tables of one capture."""

    def write(self, batch: Batch) -> None:
        """Take the next batch."""

    def close(self) -> None:
        """Write what is left."""


def require(format: OutputFormat) -> None:
    """Raise ConvertError where a package that writes the format is missing."""
    packages, purpose = _NEEDS.get(format, ((), ""))
    for package in packages:
        needed(package, purpose)


def open_writer(format: OutputFormat, name: str, pending: Pending, tables: Tables) -> Writer:
    """A writer of the tables of the capture called `name`."""
    match format:
        case OutputFormat.JSONL:
            from protogen.convert.writers.jsonl_writer import JsonlWriter

            return JsonlWriter(name, pending)
        case OutputFormat.CSV:
            from protogen.convert.writers.csv_writer import CsvWriter

            return CsvWriter(name, pending)
        case OutputFormat.PARQUET:
            from protogen.convert.writers.arrow_writers import ParquetWriter

            return ParquetWriter(name, pending)
        case OutputFormat.ARROW:
            from protogen.convert.writers.arrow_writers import ArrowWriter

            return ArrowWriter(name, pending)
        case OutputFormat.MCAP:
            from protogen.convert.writers.mcap_json import JsonMessages
            from protogen.convert.writers.mcap_writer import McapWriter

            return McapWriter(name, _only_file(format, name), pending, tables, JsonMessages())
        case OutputFormat.MCAP_ROS2:
            from protogen.convert.writers.mcap_ros2 import Ros2Messages
            from protogen.convert.writers.mcap_writer import McapWriter

            ros = Ros2Messages(tables)
            return McapWriter(name, _only_file(format, name), pending, tables, ros)


def first_files(format: OutputFormat, name: str, tables: Tables) -> list[str]:
    """The files, relative to the output folder, that a writer of a capture may begin with."""
    match format:
        case OutputFormat.JSONL | OutputFormat.MCAP | OutputFormat.MCAP_ROS2:
            return [_only_file(format, name)]
        case OutputFormat.CSV:
            suffixes = ["csv", "columns.json"]
        case _:
            suffixes = [format]
    tables_of_all = (table.name for table in tables.all_tables)
    return [f"{table}/{name}.{suffix}" for table in tables_of_all for suffix in suffixes]


def _only_file(format: OutputFormat, name: str) -> str:
    # Both kinds of MCAP may stand beside each other.
    return f"{name}.{'ros2.mcap' if format is OutputFormat.MCAP_ROS2 else format}"


def write_all(writer: Writer, batches: Iterable[Batch], tally: Tally) -> None:
    """Write every batch, count what is in them, and close the writer whatever happens."""
    try:
        for batch in batches:
            tally.add(batch.tally)
            writer.write(batch)
    except BaseException:
        # What went wrong first is what counts: on a full disk, closing goes wrong as well.
        with suppress(Exception):
            writer.close()
        raise
    writer.close()
