"""Frames of many kinds, and types, for messages that are written in them field by field."""

from __future__ import annotations

TYPES = """
byte_order: little
endpoints: {board: Board}
types:
  kind: {type: uint8, values: {one: 1, two: 2}, closed: true}
  point: {fields: {x: sint16, tag: {type: uint8, const: 7}, y: {type: sint16, default: -3}}}
  row: {fields: {cells: {type: sint16, count: 3, range: [-100, 100]}, end: point}}
  step: {fields: {kind: kind, level: {type: uint16, byte_order: big, range: [2, 300]}}}
"""
FRAMES = {
    "cobs": """
frame:
  id: {type: uint8, id: true}
  number: {type: uint8, counter: true}
  payload: {}
  crc: {type: uint16, algorithm: CRC-16/MODBUS, covers: id..payload}
  end: {literal: 0x00}
transparency: {covers: id..crc, encoding: cobs}
""",
    "short_cobs": """
frame:
  id: {type: uint8, id: true}
  payload: {}
  sum: {type: uint8, algorithm: sum-8, covers: id..payload}
  end: {literal: 0x00}
transparency: {covers: id..sum, encoding: cobs}
""",
    "slip": """
frame:
  id: {type: uint8, id: true}
  payload: {}
  end: {literal: 0xC0}
transparency: slip
""",
    "base16": """
frame:
  begin: {literal: {text: b}}
  id: {type: uint8, id: true}
  payload: {}
  end: {literal: {text: e}}
transparency: {covers: id..payload, encoding: base16-upper}
""",
    "trimmed": """
frame:
  start: {literal: 0x55, unprotected: start}
  length: {type: uint8, counts: payload}
  id: {type: uint8, id: true}
  payload: {trailing_zeros: trimmed}
  sum: {type: uint8, algorithm: sum-8, covers: length..payload}
decisions:
  start: {question: One inside?, document: No., choice: The sum tells., because: Nothing else.}
""",
    "plain": """
frame:
  start: {literal: 0x55, unprotected: start}
  id: {type: uint8, id: true}
  length: {type: uint16, counts: payload}
  payload: {}
  sum: {type: uint8, algorithm: sum-8, covers: id..payload}
decisions:
  start: {question: One inside?, document: No., choice: The sum tells., because: Nothing else.}
""",
}
