"""A schema with one thing that can't be read: that is said, and nothing that only follows from it.

The schemas of the repository have no problems, so whatever else is reported is a guess.
"""

from __future__ import annotations

import copy
from collections.abc import Iterator
from pathlib import Path
from random import Random
from types import ModuleType
from typing import Any

import pytest
import yaml
from compiled import module_at
from passes_support import HEAD, SCHEMAS, codes_of, compile_text

from protogen.problems import Problems, SourceMap, Span
from protogen.problems.sources import split_lines
from protogen.runtime.errors import EncodeError
from protogen.schema.text.compose import FAST_LOADER, PURE_LOADER
from protogen.schema.text.document import parse_document, read_document
from protogen.schema.text.nodes import to_data

OF_SHAPE = {"PG100", "PG101", "PG102", "PG103"}
WRONG: tuple[Any, ...] = (
    {"nonsense": {"of": [1]}},
    [[1]],
    "Not A Name!",
    1.5,
    True,
    -1,
)
"""Most places can't have most of these. Where one fits, the schema says something else."""
Steps = tuple[Any, ...]


def data_of(name: str) -> Any:
    document = read_document(SCHEMAS / f"{name}.yaml", Problems(), SourceMap())
    assert document is not None
    return plain(to_data(document.root))


def plain(data: Any) -> Any:
    """Without the classes that know how numbers were written."""
    if isinstance(data, dict):
        return {key: plain(value) for key, value in data.items()}
    if isinstance(data, list):
        return [plain(item) for item in data]
    if isinstance(data, bool) or not isinstance(data, int | float):
        return data
    return int(data) if isinstance(data, int) else float(data)


def places(data: Any, steps: Steps = ()) -> Iterator[Steps]:
    pairs = data.items() if isinstance(data, dict) else enumerate(data)
    for step, value in pairs:
        if step not in ("source", "doc"):
            yield (*steps, step)
            if isinstance(value, dict | list):
                yield from places(value, (*steps, step))


def spoilt(data: Any, place: Steps, wrong: Any) -> str:
    data = copy.deepcopy(data)
    around = data
    for step in place[:-1]:
        around = around[step]
    around[place[-1]] = wrong
    return yaml.safe_dump(data, sort_keys=False, allow_unicode=True)


@pytest.mark.parametrize("name", ["matty", "rflex", "uherobot", "dagny", "rn1"])
def test_what_cant_be_read_has_no_consequences(name: str) -> None:
    dice = Random(name)
    data = data_of(name)
    # All types written as one thing that is none: their names are written nowhere then.
    found = [place for place in places(data) if len(place) > 1]
    unread = 0
    for place in dice.sample(found, 25):
        wrong = dice.choice(WRONG)
        codes = codes_of(compile_text(spoilt(data, place, wrong)))
        if OF_SHAPE & set(codes):
            assert set(codes) <= OF_SHAPE, (place, wrong)
            unread += 1
    assert unread


def test_the_rest_of_a_message_is_checked() -> None:
    text = f"""\
{HEAD}
frame: {{id: {{type: uint8, id: true}}, payload: {{}}, end: {{literal: 0xC0}}}}
transparency: slip
messages:
  gyro:
    id: 1
    from: robot
    fields:
      points: {{type: uint8, scale: much}}
      angles: {{type: uint16, count: points}}
      state: {{type: unit8}}
"""
    assert codes_of(compile_text(text)) == ["PG102", "PG104"]


@pytest.mark.parametrize(
    "frame",
    ["[1]", "{id: {type: uint8, id: 5}, payload: {}}", "{host: {payload: {}}, robot: 5}"],
)
def test_fields_are_checked_without_a_frame(frame: str) -> None:
    message = "messages: {gyro: {id: 1, from: robot, fields: {angle: unit16}}}\n"
    assert codes_of(compile_text(f"{HEAD}frame: {frame}\n{message}"))[-1] == "PG104"


# --- places -------------------------------------------------------------------------------------

PIECES = [
    "{",
    "[",
    "]",
    "}",
    '"',
    "'",
    "\n",
    "\n\n",
    " ",
    "a: ",
    "- ",
    "|",
    "&x",
    "*x",
    "?",
    "\r\n",
]


def lies_in(span: Span, lines: list[str]) -> bool:
    ends = ((span.line, span.column), (span.end_line, span.end_column))
    return all(
        1 <= line <= len(lines) and 1 <= column <= len(lines[line - 1]) + 1 for line, column in ends
    )


@pytest.mark.parametrize("loader", [FAST_LOADER, PURE_LOADER])
def test_what_the_parser_misses_is_missed_inside_of_the_text(loader: Any) -> None:
    dice = Random(1)
    for _ in range(300):
        text = "".join(dice.choices(PIECES, k=dice.randrange(12)))
        problems = Problems()
        parse_document(text, "schema.yaml", problems, loader=loader)
        lines = split_lines(text)
        for problem in problems:
            spans = [problem.span, *(span for span, _ in problem.notes)]
            assert all(span is None or lies_in(span, lines) for span in spans), (text, problem)


# --- builtins -----------------------------------------------------------------------------------


def test_messages_may_be_called_like_exceptions(tmp_path: Path) -> None:
    """Generated code names none of them, and comparisons of its dataclasses still work."""
    path = tmp_path / "demo.yaml"
    names = ("value_error", "key_error", "type_error", "exception", "warning", "ellipsis")
    messages = "".join(
        f"  {name}: {{id: {index}, from: robot, fields: {{a: uint8}}}}\n"
        for index, name in enumerate(names)
    )
    frame = "frame: {id: {type: uint8, id: true}, payload: {}, end: {literal: 0xC0}}\n"
    path.write_text(f"{HEAD}{frame}transparency: slip\nmessages:\n{messages}", encoding="utf-8")
    module: ModuleType = module_at(path)
    for name in names:
        message = module.MESSAGES[name](a=1)
        assert module.decode(module.encode(message), sender="robot") == message
        assert message != 1
        with pytest.raises(EncodeError):
            module.encode(module.MESSAGES[name](a=256))
