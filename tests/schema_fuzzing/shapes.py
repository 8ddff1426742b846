"""In words what occurs in a schema, to see that everything does."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

from schema_fuzzing.frames import FramePlan
from schema_fuzzing.setting import ELSE

_FIELD_KEYS = (
    "values", "closed", "flags", "bits", "const", "default", "range", "scale", "offset", "unit",
    "special", "byte_order", "unknown", "switch", "packed", "digits",
    "code", "padding", "chars", "when", "fraction", "case", "empty", "until", "optional", "part",
)  # fmt: skip

_CODES = (
    "none", "substitute", "escape-invert", "escape-none", "escape-xor", "base16", "cobs", "slip",
    "hdlc",
)  # fmt: skip
_STARTS = ("protected", "unprotected", "set", "after end", "anywhere")

COMMON = (
    "7 bits a byte", "8 bits a byte", "one frame for all", "frames of 2 senders", "several senders",
    "byte order: None", "byte order: big", "byte order: little", "byte order: each sender",
    "byte order of a message", "byte order of a part", "field with byte_order", "lenient",
    "size: by the end", "size: by the message", "size: length", "size: length with a range",
    "counter", "value", "choice", "start: choice", "start: by position",
    "checksum over wire", "checksum when payload", "algorithm: parameters",
    "text as a part: id", "text as a part: literal", "text as a part: value",
    "bits as parts", "bits as parts: id", "bits as parts: const", "bits as parts: counter",
    "bits as parts: range", "bits as parts: default",
    "bits as parts: algorithm", "bits as parts: takes",
    "bits as parts: repeats", "bits as parts: complements", "part that repeats",
    "part that complements", "part that follows from a length", "several lengths",
    "several identities", "overload by size", "overload by undecidable", "unspecified payload",
    "empty message",
    "separated fields", "separated fields, one in front", "virtual part", "told part",
    "told length",
    "type: ascii", "type: bytes", "type: bool", "type: byte", "type: char", "type: float32",
    "type: float64", "type: decimal", "type: hexadecimal", "type: struct", "type: switch",
    "declared struct", "declared number",
    "number: fixed", "number: counted", "number: fill", "number: fill, bounded", "struct: fixed",
    "struct: counted", "struct: fill", "ascii: fixed", "ascii: counted", "bytes: counted",
    "bytes: fill", "number: fill from a least number",
    "number: worked out", "ascii: worked out", "switch by an expression",
    "case of all others",
    "number in bytes", "region", "last element", "trailing zeros left out",
    "greatest frame", "several forms", *(f"field with {key}" for key in _FIELD_KEYS),
    *(f"identity parts: {count}" for count in range(4)),
    *(f"checksums: {count}" for count in range(3)),
    *(f"transparency: {code}" for code in _CODES), *(f"start: {start}" for start in _STARTS),
    "end: protected", "end: unprotected", "end: none", "end: silence",
)  # fmt: skip
"""Shapes that a few hundred schemas hold."""

PAIRS = (
    *(f"start and transparency: {start}, {code}" for start in _STARTS for code in _CODES),
    *(
        f"end and transparency: {end}, {code}"
        for end in ("protected", "unprotected", "none")
        for code in _CODES
        if (end, code) != ("protected", "escape-none")
    ),
)
"""Shapes that some thousand schemas hold."""


def shapes_of(data: dict[str, Any], frames: Sequence[FramePlan], byte_bits: int) -> Iterator[str]:
    """Shapes that occur, each at least once."""
    yield f"{byte_bits} bits a byte"
    if "forms" in data:
        yield "several forms"
    else:
        is_shared = "payload" in data["frame"]
        yield "one frame for all" if is_shared else f"frames of {len(frames)} senders"
    for parts in frames_of(data):
        if any("told" in part and "counts" not in part for part in parts.values()):
            yield "told part"
        if any("told" in part and "counts" in part for part in parts.values()):
            yield "told length"
    order = data.get("byte_order")
    yield f"byte order: {'each sender' if isinstance(order, dict) else order}"
    for frame in frames:
        yield from _frame(frame)
    for message in data["messages"].values():
        yield from _message(message)
    for declared in data.get("types", {}).values():
        yield "declared struct" if "fields" in declared else "declared number"
        yield from _field(declared)
    for entry in data.get("overloads", {}).values():
        yield f"overload by {entry['by']}"


def frames_of(data: dict[str, Any]) -> list[dict[str, Any]]:
    """The parts of each frame of a schema."""
    if "forms" in data:
        return [form["frame"] for form in data["forms"].values()]
    written: dict[str, Any] = data["frame"]
    return [written] if "payload" in written else list(written.values())


def _frame(frame: FramePlan) -> Iterator[str]:
    code = "none" if frame.code is None else frame.code.kind
    start = _start(frame)
    end = _mark(frame, frame.closing)
    roles = [part.role for part in frame.parts]
    yield f"transparency: {code}"
    yield f"start: {start}"
    yield f"end: {end}"
    if frame.silence is not None:
        yield "end: silence"
    yield f"start and end: {start}, {end}"
    yield f"start and transparency: {start}, {code}"
    yield f"end and transparency: {end}, {code}"
    yield f"size: {_size(frame)}"
    yield f"identity parts: {roles.count('id')}"
    yield f"checksums: {roles.count('checksum')}"
    yield from (role for role in roles if role in ("counter", "value", "choice"))
    if frame.opening and frame.parts[0].role == "choice":
        yield "start: choice"
    if "unprotected" in frame.parts[0].data and not frame.opening:
        yield "start: by position"
    if frame.lenient:
        yield "lenient"
    if frame.limit is not None:
        yield "greatest frame"
    if any("trailing_zeros" in part.data for part in frame.parts):
        yield "trailing zeros left out"
    if any("longer" in part.data for part in frame.parts):
        yield "longer payloads cut"
    yield from _lengths(frame)
    for part in frame.parts:
        yield from _part(part.data)


def _lengths(frame: FramePlan) -> Iterator[str]:
    lengths = {part.name for part in frame.parts if part.role == "length"}
    if len(lengths) > 1:
        yield "several lengths"
    for part in frame.parts:
        if lengths & {part.data.get("repeats"), part.data.get("complements")}:
            yield "part that follows from a length"


def _start(frame: FramePlan) -> str:
    if frame.opening:
        return _mark(frame, frame.opening)
    if frame.starts_with_set:
        return "set"
    return "after end" if frame.closing else "anywhere"


def _mark(frame: FramePlan, places: tuple[int, ...]) -> str:
    if not places:
        return "none"
    accepted = any("unprotected" in frame.parts[index].data for index in places)
    return "unprotected" if accepted else "protected"


def _size(frame: FramePlan) -> str:
    length = next((part for part in frame.parts if part.role == "length"), None)
    if length is None:
        return "by the end" if frame.closing else "by the message"
    return "length with a range" if "range" in length.data else "length"


def _part(data: dict[str, Any]) -> Iterator[str]:
    if "algorithm" in data:
        algorithm = data["algorithm"]
        yield f"algorithm: {algorithm if isinstance(algorithm, str) else 'parameters'}"
        yield f"checksum over {data.get('over', 'content')}"
        if "when" in data:
            yield "checksum when payload"
    if "byte_order" in data:
        yield "byte order of a part"
    yield from (f"part that {key}" for key in ("repeats", "complements") if key in data)
    if "bits" in data:
        several = [item for item in data["bits"].values() if isinstance(item, dict)]
        yield "bits as parts"
        yield from (f"bits as parts: {key}" for item in several for key in item)
    if data.get("type") == "ascii":
        role = next((key for key in ("id", "literal") if key in data), "value")
        yield f"text as a part: {role}"


def _message(data: dict[str, Any]) -> Iterator[str]:
    identity = data.get("id")
    values = identity.values() if isinstance(identity, dict) else [identity]
    if any(isinstance(item, list) and len(item) > 1 for item in values):
        yield "several identities"
    yield "several senders" if isinstance(data["from"], list) and data["from"][1:] else "one sender"
    if "byte_order" in data:
        yield "byte order of a message"
    if "parts" in data:
        yield "virtual part"
    if "separator" in data:
        in_front = isinstance(data["separator"], dict) and data["separator"].get("in_front")
        yield f"separated fields{', one in front' if in_front else ''}"
    fields = data.get("fields", {})
    if fields == "unspecified":
        yield "unspecified payload"
    elif not fields:
        yield "empty message"
    else:
        for item in fields.values():
            yield from _field(item)


def _field(item: Any) -> Iterator[str]:
    if isinstance(item, str):
        yield f"type: {item}"
        return
    kind = item.get("type", "struct" if "fields" in item else "switch")
    yield f"type: {kind}"
    yield from (f"field with {key}" for key in _FIELD_KEYS if key in item)
    if "switch" in item:
        yield from _switch(item)
    for key in ("count", "size"):
        if key in item:
            element = kind if kind in ("ascii", "bytes", "struct") else "number"
            yield f"{element}: {_extent(item[key])}"
    if "element" in (item.get("until") if isinstance(item.get("until"), dict) else ()):
        yield "last element"
    if "size" in item and kind not in ("ascii", "bytes"):
        yield "region" if "fields" in item and "count" not in item else "number in bytes"
    inner = [*item.get("fields", {}).values(), *item.get("cases", {}).values()]
    for field in inner:
        yield from _field(field)


def _switch(item: Any) -> Iterator[str]:
    if not item["switch"].replace("_", "").isalnum():
        yield "switch by an expression"
    if ELSE in item["cases"]:
        yield "case of all others"


def _extent(extent: Any) -> str:
    if isinstance(extent, int):
        return "fixed"
    if isinstance(extent, dict):
        if extent.get("min"):
            return "fill from a least number"
        return "fill, bounded" if "max" in extent else "fill"
    if extent == "fill":
        return extent
    return "counted" if extent.replace("_", "").isalnum() else "worked out"
