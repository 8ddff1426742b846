"""Messages whose numbers of elements are given first, when their frames are begun in a buffer."""

from __future__ import annotations

from c_in_place_frames import FRAMES, TYPES

WORKED_OUT = """
  doubled:
    id: 0x20
    from: board
    fields:
      n: {type: uint8, range: [1, 20]}
      x: {type: uint16, count: n * 2, range: [5, 4000]}
      y: {type: uint8, count: n // 2}
      tail: {type: sint16, default: -7}
  grid:
    id: 0x21
    from: board
    fields:
      rows: {type: uint8, range: [0, 6]}
      columns: {type: uint16, range: [1, 5]}
      cells: {type: point, count: rows * columns}
      number: {type: uint16, byte_order: big, range: [1, 9]}
      sums: {type: sint24, count: rows + columns - 1}
      steps: {type: step, count: 2}
  shifted:
    id: 0x22
    from: board
    fields: {n: {type: sint8, range: [-3, 40]}, x: {type: bytes, size: n + 3}, end: uint16}
  keyed:
    id: 0x23
    from: board
    fields:
      key: {type: uint8, bits: {size: 0..3, kind: 5..7}}
      x: {type: uint32, count: key.size, range: [0, 90000]}
"""
IN_STRUCTS = """
  headed:
    id: 0x24
    from: board
    fields:
      status: {type: uint8, default: 3}
      head:
        fields:
          kind: kind
          n: {type: uint8, range: [2, 12]}
          big: {type: uint16, default: 300}
      x: {type: uint16, count: head.n, range: [1, 4000]}
      level: {type: sint24, range: [-5, -1]}
      name: {type: ascii, size: 5, default: flash}
  plainly:
    id: 0x25
    from: board
    fields:
      head: {fields: {a: uint8, n: {type: uint8, range: [1, 40]}}}
      x: {type: ascii, size: head.n}
  deep:
    id: 0x26
    from: board
    fields:
      a: {type: uint8, range: [0, 5]}
      x: {type: bytes, size: a * 2}
      at:
        fields:
          one: uint8
          inner: {fields: {two: uint8, n: {type: uint16, byte_order: big, range: [0, 20]}}}
          last: uint8
      data: {type: bytes, size: at.inner.n}
      again: {type: row, count: at.inner.n // 8 + a}
"""
TOGETHER = """
  pair:
    id: 0x30
    from: board
    fields:
      n: uint8
      x: {type: uint16, count: n}
      m: uint8
      y: {type: step, count: m}
      end: {type: uint8, default: 9}
  named:
    id: 0x31
    from: board
    fields:
      n: uint8
      name: {type: ascii, size: n}
      points: {type: point, count: {fill: true, max: 36}}
  noted:
    id: 0x32
    from: board
    fields:
      n: uint8
      m: uint8
      x: {type: uint16, count: n}
      y: {type: bytes, size: m}
      text: {type: ascii, size: fill}
"""
NUMBERS_FIRST = {
    "doubled": ("n",),
    "grid": ("rows", "columns"),
    "shifted": ("n",),
    "keyed": ("key",),
    "headed": ("head.n",),
    "plainly": ("head.n",),
    "deep": ("a", "at.inner.n"),
    "pair": ("n", "m"),
    "named": ("n",),
    "noted": ("n", "m"),
}
"""The numbers that `begin` of each message takes."""
OTHERS_FIRST = {"struct sampler_counted": ("count", "length", "other_length")}
"""Those of messages of other schemas, by their structs."""
BITS = {"key.size": "(message->key & 15U)"}
"""The C of numbers that are some bits of a field."""
FILLED = ("named", "noted")
"""Messages of which something fills the payload."""


def first_schema(name: str, frame: str) -> str:
    """The messages in frames of one kind, none of which has more than 420 bytes."""
    limit = f"max_frame: 420{TYPES.rstrip()}"
    messages = "".join(text.rstrip() for text in (WORKED_OUT, IN_STRUCTS, TOGETHER))
    return f"protocol: {name}{FRAMES[frame]}{limit}\nmessages:{messages}\n"
