"""One message in several framings, as generated C decodes and encodes it."""

from __future__ import annotations

import sys
from pathlib import Path

from c_costs.protocols import FOLDER, Protocol
from c_costs.toolchains import run
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
HEADER = FOLDER / "subjects" / "use_protogen_framed.h"


def framed(workshop: Workshop, title: str) -> Subject:
    """The message's codec in one of the framings."""
    folder = workshop.folder / f"framing{list(FRAMINGS).index(title)}"
    folder.mkdir()
    schema = folder / "framed.yaml"
    schema.write_text(SCHEMA.format(framing=FRAMINGS[title]), encoding="utf-8")
    command = [sys.executable, "-m", "protogen", "generate", str(schema), "-o", str(folder)]
    run([*command, "--quiet", "--target", "c", "--events", "messages", "--sender", "board"])
    source: Path = folder / "c" / "framed.c"
    protocol = Protocol("framed", title, schema, "board", ("sample",), 8, 0, b"")
    lto = ("-DFRAMED_APART=static",)
    return Subject(
        "messages", protocol, HEADER, (source.parent,), (source,), ("-DBENCH_POLLS",), lto
    )
