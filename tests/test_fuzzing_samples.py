"""Samples of messages: values that a codec takes."""

from __future__ import annotations

from itertools import islice
from pathlib import Path
from random import Random

from compiled import protocol_of

from protogen.fuzzing.samples import samples

KEYED = """
protocol: keyed
endpoints: {host: Host}
byte_order: little
frame:
  length: {type: uint8, counts: payload}
  id: {type: uint8, id: true}
  payload: {}
  crc: {type: uint16, algorithm: CRC-16/KERMIT, covers: length..payload}
messages:
  write:
    id: 1
    from: host
    fields:
      items:
        count: {fill: true, max: 9}
        fields:
          key: {type: uint32, bits: {item: 0..11, size: 28..30}}
          value: {switch: key.size, cases: {1: uint8, 4: uint32}}
"""


def test_bits_that_select_have_a_case(tmp_path: Path) -> None:
    path = tmp_path / "keyed.yaml"
    path.write_text(KEYED)
    protocol = protocol_of(path)
    (message,) = protocol.messages
    drawn = list(islice(samples(message, protocol.senders[0].frame, Random(1)), 200))
    items = [item for fields, _ in drawn for item in fields["items"]]
    sizes = {item["key"] >> 28 & 7 for item in items}
    assert sizes == {1, 4}
    assert len({item["key"] & 0xFFF for item in items}) > 10
    assert max(len(fields["items"]) for fields, _ in drawn) == 9
