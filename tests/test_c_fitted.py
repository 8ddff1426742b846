"""Payloads that are cut or filled, with a part behind them that events show, in C."""

from __future__ import annotations

from pathlib import Path

import pytest
from c_engine import check_events, process_of
from compiled import module_at

from protogen.targets.c.options import COptions

SCHEMA = """
protocol: fitted
endpoints: {{station: Weather station}}
byte_order: little
frame:
  start: {{literal: 0x7E}}
  kind: {{type: uint8, id: true}}
  length: {{type: uint8, counts: payload}}
  payload: {payload}
  number: {{type: uint8, counter: true}}
  check: {{type: uint8, algorithm: sum-8, covers: kind..number}}
transparency:
  covers: kind..check
  escape: {{byte: 0x7D, of: [0x7D, 0x7E], transform: {{xor: 0x20}}}}
messages:
  wind:
    id: 0x01
    from: station
    fields:
      direction: {{type: uint16, range: [0, 359]}}
      speed: sint16
"""
# Start, wind, six bytes: 10, -10, and two that nobody knows; number 77, and the sum.
LONGER = bytes.fromhex("7E 01 06 0A 00 F6 FF AA BB 4D B8")
# Start, wind, one byte: 10, whose second byte and the speed are zeros; number 77, and the sum.
TRIMMED = bytes.fromhex("7E 01 01 0A 4D 59")
CASES = {
    "cut": ("{longer: cut}", LONGER, -10),
    "trimmed": ("{trailing_zeros: trimmed}", TRIMMED, 0),
    "both": ("{trailing_zeros: trimmed, longer: cut}", TRIMMED, 0),
}


@pytest.mark.parametrize("events", ["all", "messages"])
@pytest.mark.parametrize("case", CASES)
def test_a_part_behind_a_payload_is_that_of_the_frame(
    case: str, events: str, tmp_path: Path
) -> None:
    payload, frame, speed = CASES[case]
    path = tmp_path / "fitted.yaml"
    path.write_text(SCHEMA.format(payload=payload), encoding="utf-8")
    module = module_at(path)
    [event] = module.Decoder("station").feed(frame)
    assert (event.parts.number, event.message.direction, event.message.speed) == (77, 10, speed)
    steps = [(kind, frame) for kind in ("push", "feed")]
    options = COptions(events="messages") if events == "messages" else COptions()
    check_events(process_of(path, options), module, "station", [*steps, ("flush",)])
