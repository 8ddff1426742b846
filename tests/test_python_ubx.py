"""UBX of u-blox receivers: Fletcher's checksum modulo 256, its sum of bytes sent first."""

from __future__ import annotations

from pathlib import Path
from types import ModuleType

import pytest

import protogen
from protogen.targets.python.emit import source

SCHEMA = """\
protocol: ubx
endpoints: {host: Host, receiver: GNSS receiver}
byte_order: little
frame:
  sync:     {literal: {hex: B5 62}, unprotected: sync_in_data}
  class_id: {type: uint8, id: true}
  msg_id:   {type: uint8, id: true}
  length:   {type: uint16, counts: payload, range: [0, 512]}
  payload:  {}
  ck:       {type: uint16, algorithm: fletcher-16/256, covers: class_id..payload}
decisions:
  sync_in_data: {question: May it occur?, document: Silent., choice: Yes., because: Length ends it.}
messages:
  poll_posllh: {id: {class_id: 1, msg_id: 2}, from: host, fields: {}}
  upload:
    id: {class_id: 0x0B, msg_id: 0x33}
    from: host
    fields: {data: {type: bytes, size: {fill: true, max: 512}}}
"""


@pytest.fixture(scope="module")
def ubx(tmp_path_factory: pytest.TempPathFactory) -> ModuleType:
    schema: Path = tmp_path_factory.mktemp("ubx") / "ubx.yaml"
    schema.write_text(SCHEMA)
    return protogen.module_of(protogen.load(schema))


def test_a_poll_of_the_position(ubx: ModuleType) -> None:
    frame = bytes.fromhex("B5 62 01 02 00 00 03 0A")
    assert ubx.encode(ubx.PollPosllh()) == frame
    assert ubx.decode(frame, sender="host") == ubx.PollPosllh()


def test_a_long_frame_with_bytes_that_modulo_255_would_lose(ubx: ModuleType) -> None:
    data = b"\xff" * 300 + bytes(range(200))
    covered = bytes.fromhex("0B 33 F4 01") + data
    ck_a = ck_b = 0
    for byte in covered:
        ck_a = (ck_a + byte) % 256
        ck_b = (ck_b + ck_a) % 256
    frame = b"\xb5\x62" + covered + bytes((ck_a, ck_b))
    assert ubx.encode(ubx.Upload(data=data)) == frame
    assert ubx.decode(frame, sender="host") == ubx.Upload(data=data)
    broken = frame.replace(b"\xff", b"\0", 1)
    (event,) = (event for event in ubx.Decoder(sender="host").feed(broken) if event.offset == 0)
    assert (event.kind, event.reason) == ("invalid", "checksum")


def test_modulo_255_is_printed_without_its_modulus(tmp_path: Path) -> None:
    for name, printed in (("", "Fletcher16()"), ("/256", "Fletcher16(modulus=256)")):
        schema = tmp_path / "ubx.yaml"
        schema.write_text(SCHEMA.replace("fletcher-16/256", f"fletcher-16{name}"))
        assert f"_checksum.{printed}" in source(protogen.load(schema)).module
