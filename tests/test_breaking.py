"""Each rule has an example, two small schemas, and in `breaking/` what the step between them does.

`old.yaml` and `new.yaml` are whole schemas; without a `new.yaml` the schema is gone. A line of
`expected.txt` is a finding: the rule, the place, who is affected, and how. There may be these
findings and no others. The frames that show a finding are read here with both versions' generated
Python, past everything in `protogen.evolution`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cache
from pathlib import Path
from types import ModuleType
from typing import Any, NamedTuple

import pytest
from cli_support import run

from protogen.compiler import compile_file
from protogen.evolution.examples import FOLDER
from protogen.evolution.findings import SHOWN_BY_FRAMES, Finding, Gate, findings, gone
from protogen.evolution.observe import Reading
from protogen.evolution.rules import BY_NAME, RULES
from protogen.evolution.witness import Harm, Witness
from protogen.live.codec import module_of
from protogen.model.protocol import Protocol
from protogen.runtime.values import as_dict

EXPECTED = Path(__file__).parent / "breaking"
NAMES = sorted(path.name for path in EXPECTED.iterdir())
STEPS = [name for name in NAMES if (FOLDER / name / "new.yaml").exists()]


class Expected(NamedTuple):
    rule: str
    place: str
    affected: str
    harm: str


def expected(name: str) -> list[Expected]:
    lines = (EXPECTED / name / "expected.txt").read_text(encoding="utf-8").splitlines()
    return [Expected(*line.split(" | ")) for line in lines]


@cache
def protocol(name: str, version: str) -> Protocol:
    compilation = compile_file(FOLDER / name / f"{version}.yaml")
    assert compilation.protocol is not None, compilation.problems
    return compilation.protocol


@cache
def found(name: str) -> list[Finding]:
    return findings(protocol(name, "old"), protocol(name, "new"))[1]


def test_each_rule_has_a_folder() -> None:
    assert [rule.name for rule in RULES if rule.name not in NAMES] == []
    assert [name for name in NAMES if name not in BY_NAME] == []


@pytest.mark.parametrize("name", STEPS)
class TestRule:
    def test_finds_exactly_this(self, name: str) -> None:
        seen = [
            Expected(item.rule.name, item.change.place, item.affected, item.harm)
            for item in found(name)
        ]
        assert sorted(seen) == sorted(expected(name))
        assert name in {item.rule for item in expected(name)}

    def test_has_the_category_of_the_rule(self, name: str) -> None:
        for item in found(name):
            assert item.rule is BY_NAME[item.change.rule]
            assert item.category is item.rule.category

    def test_finds_nothing_between_equals(self, name: str) -> None:
        for version in ("old", "new"):
            same = protocol(name, version)
            assert findings(same, same)[1] == []

    def test_frames_show_what_is_grave(self, name: str) -> None:
        modules = {version: module_of(protocol(name, version)) for version in ("old", "new")}
        for item in found(name):
            is_shown = item.category in SHOWN_BY_FRAMES and item.rule.by_frame
            assert bool(item.witnesses) == is_shown
            for witness in item.witnesses:
                check_witness(witness, modules)

    def test_the_gate_refuses_what_is_grave(self, name: str) -> None:
        done = run("breaking", *(str(FOLDER / name / f"{item}.yaml") for item in ("old", "new")))
        grave = {item.rule.name for item in found(name) if item.category in SHOWN_BY_FRAMES}
        assert done.exit_code == (1 if grave else 0), done.output
        assert all(f"[{rule}]" in done.output for rule in grave)
        assert grave or "nothing is broken" in done.output

    def test_the_gate_can_be_told_to_let_it_pass_or_to_refuse_it(self, name: str) -> None:
        old, new = protocol(name, "old"), protocol(name, "new")
        left = findings(old, new, Gate(except_=(name,)))[1]
        assert name not in {item.rule.name for item in left}
        rule = BY_NAME[name]
        only = {item.rule.name for item in findings(old, new, Gate(use=(name,)))[1]}
        assert only == (set() if rule.category.value == "NONE" else {name})


def test_a_schema_that_is_gone() -> None:
    old = protocol("schema-deleted", "old")
    comparison, (item,) = gone(old, "demo.yaml")
    seen = Expected(item.rule.name, item.change.place, item.affected, item.harm)
    assert [seen] == expected("schema-deleted")
    assert item.change.text == "demo had reading, text"
    (witness,) = item.witnesses
    assert witness.message == module_of(old).decode(witness.frame, "board").NAME
    assert witness.received.message is None
    assert comparison.new.messages == ()
    for gate in (Gate(except_=("schema-deleted",)), Gate(ignore={"*": ["demo.*"]})):
        assert gone(old, "demo.yaml", gate)[1] == []


# --- frames, read without the code under test -----------------------------------------------------


class Read(NamedTuple):
    """Reading of a frame by generated Python."""

    name: str
    raw: Mapping[str, object]
    """Every number and text by its path."""
    meaning: Mapping[str, object]
    """Values with their names, physical values and units, by the names that programs use."""
    parts: Mapping[str, object]


def read(module: ModuleType, sender: str, frame: bytes) -> Read | None:
    if sender not in module.PROTOCOL.senders:
        return None
    decoder = module.Decoder(sender)
    events = [*decoder.feed(frame), *decoder.flush()]
    messages = [event for event in events if event.kind == "message"]
    if not messages:
        return None
    message = messages[0].message
    shown = (name for name in dir(message) if not name.startswith("_") and name.islower())
    meaning = {name: getattr(message, name) for name in shown}
    return Read(
        message.NAME,
        dict(flat(message.to_dict())),
        {name: repr(value) for name, value in meaning.items() if not callable(value)}
        | {f"unit of {name}": getattr(rule, "unit", "") for name, rule in message.RULES},
        as_dict(messages[0].parts),
    )


def flat(value: Any, path: str = "") -> list[tuple[str, object]]:
    if isinstance(value, dict):
        pairs = [(f"{path}.{name}" if path else name, item) for name, item in value.items()]
        return [leaf for inner, item in pairs for leaf in flat(item, inner)]
    if isinstance(value, list):
        return [leaf for i, item in enumerate(value) for leaf in flat(item, f"{path}[{i}]")]
    return [] if value is None else [(path, value)]


def check_witness(witness: Witness, modules: Mapping[str, ModuleType]) -> None:
    """Check both readings, and that they differ as is said."""
    order: Sequence[str] = ("old", "new") if witness.old_sends else ("new", "old")
    other_names = dict(zip(*(modules[v].PROTOCOL.senders for v in order), strict=False))
    theirs = other_names.get(witness.sender, witness.sender)
    sent = read(modules[order[0]], witness.sender, witness.frame)
    received = read(modules[order[1]], theirs, witness.frame)
    assert sent is not None, witness.words
    assert sent.name == witness.message
    check_reading(sent, witness.sent)
    if witness.harm is Harm.REJECTED:
        assert received is None
        assert witness.received.message is None
        return
    assert received is not None, witness.words
    check_reading(received, witness.received)
    assert received != sent, witness.words
    named = [item.path for item in witness.differences]
    assert named or received.name != sent.name, witness.words
    for item in witness.differences:
        assert item.sent != item.received
    is_lost = all(item.received is None for item in witness.differences) and bool(named)
    if witness.harm is Harm.LOST and not is_lost:  # A name that the receiver does not know.
        assert received.raw == sent.raw, witness.words
        return
    assert (witness.harm is Harm.LOST) == is_lost


def check_reading(mine: Read, stated: Reading) -> None:
    """Check that the words that are stated begin with the values that generated Python reads."""
    assert mine.name == stated.message
    words = dict(stated.values)
    for path, value in mine.raw.items():
        shown = value.hex(" ").upper() if isinstance(value, bytes) else str(value)
        if path in words:
            assert words[path].startswith((shown, f"{value!r}")), (path, words[path], value)
    numbers = {path for path in words if not path.startswith("frame.")}
    assert {path.partition(".")[0] for path in mine.raw} <= {
        path.partition(".")[0] for path in numbers
    } | {""}
    for part, value in mine.parts.items():
        assert words[f"frame.{part}"] == str(value)
