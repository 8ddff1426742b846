"""The library that prints a sender's rows as text, compiled for its schema."""

from __future__ import annotations

from protogen.capture.layout import capture_schema
from protogen.capture.schema import CaptureSchema
from protogen.convert.columns.csv_text import quoted_characters
from protogen.convert.columns.tables import Tables
from protogen.convert.formats import OutputFormat
from protogen.convert.ros2.steps import message_steps as ros2_steps
from protogen.convert.writers.csv_steps import cell_steps
from protogen.convert.writers.jsonl_steps import line_steps
from protogen.convert.writers.mcap_steps import message_steps
from protogen.native.build import Built
from protogen.native.printer import build_printer


def built_printer(
    tables: Tables, format: OutputFormat, schema: CaptureSchema | None = None
) -> Built:
    """The library that prints a sender's rows as lines of JSON or CSV, or messages of MCAP.

    Raises NativeError, and UnprintableError where numbers of a scale are too great for C.
    """
    schema = schema or capture_schema(tables.protocol, tables.sender)
    name = f"{tables.protocol.name}_{tables.sender.name}_{format.name.lower()}"
    if format is OutputFormat.CSV:
        return build_printer(name, cell_steps(schema, tables), quoted_characters())
    if format is OutputFormat.MCAP:
        steps = message_steps(schema, tables)
        return build_printer(name, steps, byte_time=tables.byte_time)
    if format is OutputFormat.MCAP_ROS2:
        steps = ros2_steps(schema, tables)
        return build_printer(name, steps, byte_time=tables.byte_time, parts=("cdr.c",))
    return build_printer(name, line_steps(schema))
