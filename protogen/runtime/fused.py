"""Structs that are read and written in a few calls of Python's `struct`, not field by field.

`fused_pieces.py` finds out what the declaration of a struct fixes (`fused_parts.py`);
`fused_reading.py` and `fused_writing.py` print functions that do just that. They do only what is
plainly in order. For all else they raise, and construct, which they stand in front of, does it in
its own way, or says what is wrong.

Nothing of this is imported before a struct is first used.
"""

from __future__ import annotations

import io
from collections.abc import Callable
from typing import Any, BinaryIO

from protogen.runtime.constructs import Struct
from protogen.runtime.fused_function import Function
from protogen.runtime.fused_parts import Record, Unfit
from protogen.runtime.fused_pieces import record_of
from protogen.runtime.fused_reading import read_record
from protogen.runtime.fused_writing import write_record

Entry = Callable[..., Any]
"""`parse`, `parse_stream` or `build` of a construct."""

ANYTHING = Exception
"""What a printed function may raise; whatever it is, construct decides."""

STREAMS = (io.BytesIO, io.BufferedReader)
"""What goes back to where it was, once it was found that it can."""


def parse(record: Record, otherwise: Entry) -> Entry:
    """`parse` of this record; `otherwise` is asked where not all is plainly in order."""
    function = Function("parse(data, **contextkw)")
    read_record(record, function)
    return _in_front(function, "data", otherwise)


def build(record: Record, otherwise: Entry) -> Entry:
    """`build` of this record; `otherwise` is asked where not all is plainly in order."""
    function = Function("build(obj, **contextkw)")
    write_record(record, function, "obj")
    return _in_front(function, "obj", otherwise)


def parse_stream(record: Record, otherwise: Entry) -> Entry:
    """`parse_stream` of this record, whose size has to be fixed for it."""
    function = Function("read(data)")
    size = read_record(record, function)
    if size is None:
        return otherwise
    read = function.compiled()

    def parse_stream(stream: BinaryIO, **contextkw: Any) -> Any:
        if contextkw or type(stream) not in STREAMS or not stream.seekable():
            return otherwise(stream, **contextkw)
        start = stream.tell()
        data = stream.read(size)
        try:
            return read(data)
        except ANYTHING:
            stream.seek(start)
        return otherwise(stream)

    return parse_stream


def _in_front(function: Function, argument: str, otherwise: Entry) -> Entry:
    slowly = function.name(otherwise)
    function.lines = [
        "if not contextkw:",
        "    try:",
        *(f"        {line}" for line in function.lines),
        "    except Exception: pass",  # construct's error is not raised while this one is handled.
        f"return {slowly}({argument}, **contextkw)",
    ]
    entry: Entry = function.compiled()
    return entry


_ENTRIES = {
    "parse": parse,
    "parse_stream": parse_stream,
    "build": build,
}


def direct(struct: Struct, name: str, method: Callable[..., Any]) -> Callable[..., Any]:
    """The function that does what a method of the struct does: the method itself if none can."""
    try:
        return _ENTRIES[name](record_of(struct), method)
    except Unfit:
        return method
