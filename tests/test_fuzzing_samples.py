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


def test_a_mark_of_the_last_element_may_size_a_region(tmp_path: Path) -> None:
    path = tmp_path / "keyed.yaml"
    head, _, _ = KEYED.partition("messages:")
    path.write_text(
        head
        + """messages:
  write:
    id: 1
    from: host
    fields:
      items:
        until: {element: size, max: 2}
        fields:
          size: {type: uint8, range: [0, 9]}
          data: {size: size, fields: {bytes: {type: bytes, size: fill}}}
"""
    )
    protocol = protocol_of(path)
    (message,) = protocol.messages
    drawn = list(islice(samples(message, protocol.senders[0].frame, Random(1)), 100))
    assert {len(fields["items"]) for fields, _ in drawn} == {1, 2}
    for fields, _ in drawn:
        *others, last = (
            (item["size"], len(item["data"]["bytes"]) // 2) for item in fields["items"]
        )
        assert all(item == (0, 0) for item in others)
        assert 1 <= last[0] == last[1] <= 9
