"""Which messages of generated C are copied as a whole: those that lie in memory as on the wire."""

from pathlib import Path

import pytest
from compiled import protocol_of

from protogen.targets.c.emit import unit_of
from protogen.targets.c.options import COptions
from protogen.targets.c.payload.images import is_image

SCHEMA = """\
protocol: sample
byte_order: little
endpoints: {{host: Host, board: Board}}
frame:
  opening: {{literal: 0x7E}}
  id:      {{type: uint8, id: true}}
  payload: {{}}
  closing: {{literal: 0x7E}}
transparency: hdlc
messages:
  reading:
    from: board
    id: 1
    fields: {{{fields}}}
"""


@pytest.mark.parametrize(
    ("fields", "is_one"),
    [
        ("a: {type: uint32}, b: {type: sint16}", True),
        ("a: {type: uint32}, b: {type: uint16}, c: {type: uint8}", True),
        ("a: {type: uint16, count: 3}", True),
        ("a: {type: float32}, b: {type: uint8}", True),
        # At the odd place 1, which most machines leave free.
        ("a: {type: uint8}, b: {type: uint32}", False),
        ("a: {type: uint32, byte_order: big}, b: {type: uint16}", False),
        ("a: {type: uint24}, b: {type: uint24}", False),
        ("a: {type: bool}, b: {type: uint8}, c: {type: uint32, const: 7}", False),
        # So few are taken one by one.
        ("a: {type: uint16}, b: {type: uint16}", False),
    ],
)
def test_what_has_padding_or_other_bytes_in_memory_is_no_image(
    fields: str, is_one: bool, tmp_path: Path
) -> None:
    path = tmp_path / "sample.yaml"
    path.write_text(SCHEMA.format(fields=fields), encoding="utf-8")
    (message,) = protocol_of(path).messages
    assert is_image(message.plan) is is_one


def test_what_checksums_are_read_by_is_there_for_images_as_well(tmp_path: Path) -> None:
    path = tmp_path / "sample.yaml"
    fields = "a: {type: uint16, count: 3}"
    check = "  payload: {{}}\n  crc: {{type: uint16, algorithm: CRC-16/KERMIT, covers: payload}}\n"
    schema = SCHEMA.replace("  payload: {{}}\n", check)
    path.write_text(schema.format(fields=fields), encoding="utf-8")
    unit = unit_of(protocol_of(path), COptions())
    helpers = [*unit.module.helpers, *unit.framing.helpers]
    [load] = [text for text in helpers if "sample_load_u16le(" in text]
    assert load.startswith("static uint16_t sample_load_u16le(")
