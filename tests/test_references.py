"""References: every key that is marked as one is found, and follows a rename in a dialect."""

from __future__ import annotations

from textwrap import dedent
from typing import Any

import pytest

from protogen.problems import Problems, SourceMap
from protogen.schema.dialects.renames import apply_renames
from protogen.schema.load import load_syntax
from protogen.schema.references import Reference, form_under, references
from protogen.schema.syntax.forms import Form, keys_of, models_inside
from protogen.schema.syntax.protocol import SCHEMA
from protogen.schema.text.document import parse_document
from protogen.schema.text.nodes import Node, to_data

Key = tuple[str, str]
"""A syntax class and one of its keys."""

TEXT = """\
protocol: all_references
endpoints: {host: Host, robot: Robot}
byte_order: {host: little, robot: big}
max_frame: {host: 64}
frame:
  host: {code: {type: kind, id: true}, payload: {}}
  robot:
    sync: {literal: 0xFF, unprotected: accepted}
    length: {type: uint8, counts: payload}
    number: {type: uint8, id: true}
    asked: {type: uint8, told: true, set_by: [code, order.speed]}
    payload: {}
    extra: {type: uint8, virtual: true}
    sum: {type: uint8, algorithm: sum-8, covers: [length..number, payload], when: payload}
transparency: {robot: {covers: number..payload, preset: slip}}
content_covers: sync
types:
  kind: {type: uint8, values: {idle: 0, busy: 1}}
messages:
  order: {from: host, id: {code: 1}, fields: {speed: uint8}}
  report:
    from: [robot]
    id: {number: 1}
    parts: {extra: 5}
    fields:
      first: {part: number, type: uint8}
      size: uint8
      state: {type: kind, const: idle, default: idle}
      name: {type: ascii, size: size}
      list: {type: uint8, count: size}
      choice: {switch: state, cases: {busy: kind}}
      pair: {fields: {n: uint8, mask: {type: uint8, bits: {low: {bits: 0..3, values: {one: 1}}}}}}
      more: {type: uint8, when: "pair.mask.low == one or state in [busy] and size > pair.n"}
      bytes: {type: bytes, size: (pair.n + size) * 2}
      chosen: {switch: pair.mask.low, cases: {one: kind}}
      marked: {fields: {is_last: bool}, until: {element: is_last, max: 3}}
    examples:
      first:
        content: {hex: 00}
        covers: number
        sender: robot
        parts: {number: 1}
        values: {size: 0, state: idle}
        contradicts: {fails: values, why: no reason, reads: {state: busy}}
  other: {from: robot, id: {number: 1}}
overloads:
  both: {messages: [report, other], by: undecidable, yields: report, decision: accepted}
exchanges:
  talk: {steps: [order, {message: report, example: first}]}
  ask: {request: order, reply: [report], refusal: other, match: {speed: number}}
  short: {request: report, reply: order, match: size}
decisions: {accepted: {question: q, document: d, choice: c, because: b}}
reserved:
  identities: [{from: robot, id: {number: 9}}]
  fields: {report: [old]}
  values: {report.state: [3], kind: [4]}
"""


def tree(text: str) -> Node:
    problems = Problems()
    document = parse_document(text, "x.yaml", problems)
    assert document is not None, list(problems)
    return document.root


FORMS = """\
protocol: all_references_of_forms
endpoints: {robot: Robot}
forms:
  short:
    from: robot
    behind: accepted
    frame:
      number: {type: uint8, id: true}
      again: {type: uint8, repeats: number}
      not_again: {type: uint8, complements: number}
      flags:
        type: uint8
        bits:
          urgent: 0..1
          urgent_again: {bits: 2..3, repeats: urgent}
          urgent_not: {bits: 4..5, complements: urgent}
          length: {bits: 6..7, counts: flags..payload}
      payload: {}
      sum: {type: uint8, algorithm: sum-8, covers: number..payload}
      low:
        type: uint8
        bits: {half: {bits: 0..3, algorithm: xor-8, covers: again..sum, takes: 4..7}}
    transparency: {covers: payload, preset: slip}
messages:
  report:
    from: robot
    id: {number: 1}
    forms: [short]
    fields: {size: uint8}
    examples: {first: {form: short, content: {hex: 00}, covers: payload}}
decisions: {accepted: {question: q, document: d, choice: c, because: b}}
"""

ROOTS = (tree(TEXT), tree(FORMS))
DATA = to_data(ROOTS[0])


def is_marked(form: Form | None) -> bool:
    if form is None:
        return False
    return bool(form.marks) or is_marked(form.names) or is_marked(form.items)


MARKED = sorted(
    (model.__name__, str(key))
    for model in models_inside(SCHEMA)
    for key, form in keys_of(model).items()
    if is_marked(form)
)


def key_of(data: Any, found: Reference) -> Key:
    """The innermost class and key that a reference stands under."""
    form, key = SCHEMA, ("", "")
    for step in found.spot.place:
        for model in form.models:
            if step in keys_of(model):
                key = (model.__name__, str(step))
        form = form_under(data, form, step)
    if form.short is not None and not found.spot.at_key:
        key = (form.models[0].__name__, form.short)
    return key


def under(data: Any, key: Key) -> list[Reference]:
    return [found for found in references(data) if key_of(data, found) == key]


@pytest.mark.parametrize("key", MARKED, ids=".".join)
def test_a_marked_key_follows_every_rename(key: Key) -> None:
    followed = 0
    for root in ROOTS:
        data = to_data(root)
        for found in under(data, key):
            for *place, name in found.declarations(data):
                dialect = f"{{rename: {{{name}: other_name}}}}"
                for step in reversed(place):
                    dialect = f"{{{step}: {dialect}}}"
                renamed = apply_renames(root, tree(dialect), Problems())
                names = [now.name for now in under(to_data(renamed), key) if now.kind is found.kind]
                assert "other_name" in names
                followed += 1
    assert followed, "the schemas above lack a reference under this key"


def test_the_schema_is_one() -> None:
    problems = Problems()
    assert load_syntax("x.yaml", problems, SourceMap(), text=TEXT) is not None
    assert list(problems) == []


def test_a_reference_knows_its_place_in_the_text() -> None:
    covers = under(DATA, ("Part", "covers"))
    assert [(found.name, found.start) for found in covers] == [
        ("length", 0),
        ("number", len("length..")),
        ("payload", 0),
    ]
    assert covers[0].spot == covers[1].spot
    assert covers[1].declarations(DATA) == [("frame", "robot", "number")]
    assert {found.name for found in under(DATA, ("Reserved", "values"))} == {
        "report",
        "state",
        "kind",
    }


def test_a_name_of_nothing_has_no_declaration() -> None:
    data = to_data(
        tree(
            dedent("""
            endpoints: {a: A}
            messages: {m: {from: b, fields: {n: {type: uint8, count: k}}}}
            """)
        )
    )
    assert [(found.name, found.scopes, found.declarations(data)) for found in references(data)] == [
        ("b", (("endpoints",),), []),
        ("uint8", (("types",),), []),
        ("k", (("messages", "m", "fields"),), []),
    ]
