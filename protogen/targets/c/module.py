"""A protocol as the templates print it."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from fractions import Fraction
from math import ceil

import msgspec

from protogen.model.messages import Message
from protogen.model.payload_builder import plan_of
from protogen.model.payload_plan import IntegerStep, RecordStep, every_step
from protogen.model.protocol import Link, Protocol
from protogen.targets import descriptions
from protogen.targets.c import comments
from protogen.targets.c.lines import assertion
from protogen.targets.c.named import EnumView, enum_view, flags_view, string
from protogen.targets.c.options import COptions
from protogen.targets.c.payload.helpers import Helpers
from protogen.targets.c.payload.messages import MessagePrinter, MessageView
from protogen.targets.c.payload.records import Records, StructView
from protogen.targets.c.spelling import Names
from protogen.targets.naming import named_type
from protogen.version import VERSION


class Module(msgspec.Struct, frozen=True):
    """Everything that the templates print of the payloads."""

    name: str
    """What all names begin with."""
    upper: str
    file: str
    """The name of the files, but for its end."""
    doc: tuple[str, ...]
    spec_hash: str
    version: str | None
    made_by: str
    """The version of protogen."""
    made_by_number: int
    """The same version as a number, which the preprocessor can compare."""
    baud: str | None
    idle_timeout_ms: str | None
    enums: tuple[EnumView, ...]
    flags: tuple[EnumView, ...]
    structs: tuple[StructView, ...]
    messages: tuple[MessageView, ...]
    helpers: tuple[str, ...]
    """Functions that the codecs share."""
    public_helpers: tuple[str, ...]
    """Those of them that inline functions of the header call."""
    has_vectors: bool
    """True if some of these have a way for SSE2."""
    has_images: bool
    """True if some message can be copied as a whole."""
    assertions: tuple[str, ...]
    """What the source takes for granted of each compiler, of floats."""
    sinks: tuple[str, ...]
    """Functions that what writes into a writer shares."""
    floats: frozenset[int]
    """Bits of the floats that members have."""

    def message(self, name: str) -> MessageView:
        """The message of that name; raises KeyError."""
        for message in self.messages:
            if message.name == name:
                return message
        raise KeyError(name)


def view(protocol: Protocol, options: COptions, names: Names, helpers: Helpers) -> Module:
    """The module of a protocol; what codecs share becomes one of the helpers."""
    chosen = options.chosen(protocol)
    used = _used(chosen)
    sinks = Helpers(names)
    enums = tuple(enum_view(item, names) for item in protocol.enums if item.name in used)
    flags = tuple(flags_view(item, names) for item in protocol.flags if item.name in used)
    structs = [item for item in protocol.structs if item.name in used and item.holds_values]
    tags = {item.name: names.claim_tag(named_type(item.name), item.name) for item in structs}
    records = Records(tags, names, helpers)
    printer = MessagePrinter(protocol, names, helpers, sinks, records)
    struct_views = tuple(
        records.view(
            item.name,
            tags[item.name],
            descriptions.of_named(item.name, item.about),
            item.fields,
            plan_of(item.fields).steps,
        )
        for item in structs
    )
    messages = tuple(printer.view(item) for item in chosen)
    return Module(
        name=names.prefix,
        upper=names.prefix.upper(),
        file=names.file,
        doc=comments.comment(comments.of_protocol(protocol)),
        spec_hash=protocol.spec_hash,
        version=None if protocol.version is None else string(protocol.version),
        made_by=VERSION,
        made_by_number=_number_of(VERSION),
        baud=_baud(protocol.link),
        idle_timeout_ms=_milliseconds(protocol.link.idle_timeout),
        enums=enums,
        flags=flags,
        structs=struct_views,
        messages=messages,
        helpers=helpers.texts,
        public_helpers=helpers.public_texts,
        has_vectors=helpers.has_vectors,
        has_images=any(message.image for message in messages),
        assertions=tuple(_assertions(helpers.floats | sinks.floats, names)),
        sinks=sinks.texts,
        floats=frozenset(helpers.floats | sinks.floats),
    )


def _assertions(floats: set[int], names: Names) -> Iterator[str]:
    """Sizes of floats, whose bytes are copied."""
    for bits in sorted(floats):
        type_ = "float" if bits == 32 else f"{names.prefix}_float64"
        name = names.claim_helper(f"float{bits}", "size")
        yield assertion(name, f"sizeof({type_}) == {bits // 8}U")


def _number_of(version: str) -> int:
    """A version as one number, in which minor and patch have two digits each."""
    major, minor, patch = map(int, re.findall(r"\d+", version)[:3])
    return (major * 100 + minor) * 100 + patch


def _baud(link: Link) -> str | None:
    """The rate of the line; `int` may have 16 bits."""
    return None if link.baud is None else f"{link.baud}UL"


def _milliseconds(seconds: Fraction | None) -> str | None:
    """A time in whole milliseconds: more rather than less, as less would cut a frame."""
    return None if seconds is None else f"{ceil(seconds * 1000)}UL"


def _used(messages: Sequence[Message]) -> set[str]:
    """The names of the types that some messages use."""
    found: set[str] = set()
    for step in every_step(step for message in messages for step in message.plan.steps):
        if isinstance(step, IntegerStep):
            found.update(item.name for item in step.type.named_types)
        elif isinstance(step, RecordStep):
            found.add(step.type.name)
    return found
