"""Names: ordinary ones, and ones that a careless target would trip over.

The pools share no first word, so that no two paths through a schema (message, field, field of a
struct ...) give the same name when they are joined.
"""

from __future__ import annotations

from collections.abc import Container, Sequence
from functools import cache

from hypothesis import strategies as st

ENDPOINTS = ("host", "brain", "pc", "esp", "linux_box", "flex", "close", "close_set", "register")
PROTOCOLS = ("tiny", "robot_link", "serial7", "construct", "json", "typing", "string", "class")
MESSAGES = (
    "ping", "gyro", "move", "report", "status_word", "unknown", "event", "any", "final",
    "int_enum", "literal", "class_var", "fraction", "field", "dataclass", "overload", "mapping",
    "invalid", "frame", "format", "exception", "type_error", "sequence", "runtime", "noise",
    "none", "result", "reason", "decoder", "switch", "lambda", "gyro_1", "gyro1", "on_ping",
)  # fmt: skip
FIELDS = (
    "speed", "heading", "x", "y", "z1", "mode", "count", "size", "data", "value", "values",
    "raw", "name", "offset", "payload", "counter", "length", "identity", "property", "bytes",
    "str", "len", "list", "tuple", "dict", "object", "id", "type", "repr", "hash", "range",
    "min", "sum", "print", "isinstance", "sender", "encode", "decode", "fields", "message",
    "messages", "kind", "annotations", "set_point", "left_motor", "byte_order", "protocol",
    "mro", "rest", "class", "self", "long", "int", "while", "try", "this", "uint8_t", "unix",
    "to_dict",
)  # fmt: skip
TYPES = (
    "color", "axis", "vector", "words", "gain_table", "leds", "entry", "sample", "protocol_id",
    "union", "parts",
)  # fmt: skip
VALUES = (
    "ok", "off", "on", "yes", "no", "null_value", "red", "idle", "items", "mro",
    "bit_length", "from_bytes", "real", "conjugate", "low_power", "unknown_value", "number",
    "title", "none", "default",
)  # fmt: skip
SPECIAL = ("mask", "missing", "too_far", "not_ready", "unit", "static")
"""Names of values without a meaning, which stand beside those of the same field's enum."""
PARTS = (
    "start", "sync", "begin", "ident", "subclass", "command", "number", "length", "counter",
    "flavor", "crc", "checksum", "end", "stop", "tail", "marker", "timestamp", "reserved_part",
    "id", "kind", "for", "short", "strict", "sender", "self",
)  # fmt: skip
DECISIONS = ("delimiter_in_data", "taken", "choice")


def fresh(pool: Sequence[str], taken: Container[str]) -> st.SearchStrategy[str]:
    """Names out of a pool that are not taken; numbered where the pool's own all are."""
    free = [name for name in pool if name not in taken]
    if free:
        return st.sampled_from(free)
    return st.just(next(f"spare_{n}" for n in range(2, 10_000) if f"spare_{n}" not in taken))


@cache
def several(pool: tuple[str, ...], least: int, greatest: int) -> st.SearchStrategy[list[str]]:
    """Different names out of a pool."""
    return st.lists(st.sampled_from(pool), min_size=least, max_size=greatest, unique=True)
