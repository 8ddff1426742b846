"""One message in several framings, as generated C decodes and encodes it."""

from __future__ import annotations

from pathlib import Path

from c_costs.protocols import Protocol
from c_costs.workshop import Subject, Workshop

FRAMINGS = {
    "COBS, a zero at the end": """\
  id:      {type: uint8, id: true}
  payload: {}
  crc:     {type: uint16, algorithm: CRC-16/KERMIT, covers: [id, payload]}
  end:     {literal: 0}
transparency: {encoding: cobs}
""",
    "SLIP, `END` on both sides": """\
  begin:   {literal: 0xC0}
  id:      {type: uint8, id: true}
  payload: {}
  crc:     {type: uint16, algorithm: CRC-16/KERMIT, covers: [id, payload]}
  end:     {literal: 0xC0}
transparency: slip
""",
    "HDLC, flags on both sides": """\
  opening: {literal: 0x7E}
  id:      {type: uint8, id: true}
  payload: {}
  crc:     {type: uint16, algorithm: CRC-16/KERMIT, covers: [id, payload]}
  closing: {literal: 0x7E}
transparency: hdlc
""",
    "two bytes of synchronisation, a length": """\
  sync:    {literal: [0xAA, 0x55], unprotected: sync_in_data}
  length:  {type: uint8, counts: payload}
  id:      {type: uint8, id: true}
  payload: {}
  crc:     {type: uint16, algorithm: CRC-16/KERMIT, covers: [length, id, payload]}
decisions:
  sync_in_data:
    question: What keeps the synchronisation word out of the data?
    document: Nothing does.
    choice: A receiver looks for the next one inside of what fails.
    because: So it is with most protocols of this shape.
""",
}
SCHEMA = """\
protocol: framed
title: A message in a frame
byte_order: little
link: {{baud: 115200}}
endpoints: {{host: Computer, board: Board}}

frame:
{framing}
messages:
  sample:
    id: 0x10
    from: board
    fields:
      time:  {{type: uint32}}
      speed: {{type: sint16}}
      force: {{type: uint16}}
"""


def framed(folder: Path, title: str) -> tuple[Workshop, Subject]:
    """The message's codec in one of the framings, and where it is built."""
    workshop = Workshop(folder / f"framing{list(FRAMINGS).index(title)}")
    workshop.folder.mkdir()
    schema = workshop.folder / "framed.yaml"
    schema.write_text(SCHEMA.format(framing=FRAMINGS[title]), encoding="utf-8")
    protocol = Protocol("framed", title, schema, "board", ("sample",), 8, 0, b"")
    return workshop, workshop.subject("messages", protocol)
