"""Random edits of random schemas: no finding, no difference; a finding, a frame that shows it."""

from __future__ import annotations

import re
import sys
from collections import Counter
from pathlib import Path
from random import Random

import pytest
from amounts import SCHEMAS_EDITED, THOROUGH
from evolution_edits import edited
from hypothesis import HealthCheck, Phase, given, seed, settings
from schema_fuzzing import Schema, schemas
from schema_fuzzing.text import to_yaml

from protogen.compiler import compile_file
from protogen.evolution import witness
from protogen.evolution.findings import SHOWN_BY_FRAMES, Verdict, findings
from protogen.evolution.witness import Witnesses
from protogen.model.protocol import Protocol

_INDEX = re.compile(r"\[\d+\]")
NAMES = (
    "enum-value-added",
    "enum-value-renamed",
    "flag-added",
    "flag-renamed",
    "bits-renamed",
    "field-kind",
    "field-of-frame",
    "field-renamed",
    "field-spelling",
    "field-special-renamed",
)
"""Changes of nothing but words. A field's path does not say in which case of a switch it is, so
where one of two fields with one name gets another, the other one seems to be new."""
SCHEMAS = 25
EDITS = 12
"""Of each schema; less than half of them compile and change something: some 500 in all."""


@pytest.mark.usefixtures("fixed_draws")
@pytest.mark.parametrize("number", range(SCHEMAS_EDITED))
def test_findings_and_frames_agree(
    number: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    if not THOROUGH:  # Fewer frames for each edit, and more edits.
        monkeypatch.setattr(witness, "ROUNDS", 24)
        monkeypatch.setattr(witness, "RANDOM", 12)
    path = tmp_path / "drawn.yaml"
    dice = Random(number)
    counted = Counter[str]()

    def compiled(data: dict[str, object]) -> Protocol | None:
        path.write_text(to_yaml(data), encoding="utf-8", newline="")
        return compile_file(path).protocol

    @seed(number)
    @settings(
        max_examples=SCHEMAS,
        database=None,
        derandomize=False,
        phases=[Phase.generate],
        suppress_health_check=list(HealthCheck),
    )
    @given(schemas())
    def each(schema: Schema) -> None:
        old = compiled(schema.data)
        assert old is not None
        for _ in range(EDITS):
            counted["edits"] += 1
            data = edited(schema.data, dice)
            new = compiled(data)
            if new is None or new.spec_hash == old.spec_hash:
                continue
            counted["compared"] += 1
            try:
                check_pair(old, new, counted)
            except BaseException:
                sys.stdout.write(f"{to_yaml(schema.data)}\n--- NEW ---\n{to_yaml(data)}\n")
                raise

    each()
    assert counted["compared"] * 4 > counted["edits"], counted
    assert counted["hidden"] * 5 < counted["findings"], counted


def check_pair(old: Protocol, new: Protocol, counted: Counter[str]) -> None:
    comparison, found = findings(old, new)
    for item in found:
        if item.category not in SHOWN_BY_FRAMES or not item.rule.by_frame:
            assert not item.witnesses
            continue
        assert bool(item.witnesses) == (item.verdict is Verdict.PROVED)
        counted["hidden"] += not item.witnesses
        counted["findings"] += 1
    grave = [item.change for item in found if item.category in SHOWN_BY_FRAMES]
    if any(change.message is None for change in grave):
        return  # The frame itself changed: any message may be read differently.
    named = {place.partition(".")[0] for c in grave for place in (c.place, *c.places)}
    fresh = {
        place
        for change in comparison.changes
        if change.rule in NAMES
        for place in (change.place, *change.places)
    }
    witnesses = Witnesses(comparison)
    for sender in old.senders:
        for message in sender.messages:
            if message.name in named:
                continue
            for seen in witnesses.differing(True, sender, message):
                paths = {_INDEX.sub("", item.path) for item in seen.differences}
                unsaid = [path for path in paths if not _is_said(f"{message.name}.{path}", fresh)]
                assert paths and not unsaid, f"no finding for {message.name}: {seen.words}"


def _is_said(path: str, places: set[str]) -> bool:
    """True if a change is at a path, or in a run of bits of the number that is there."""
    return any(place == path or place.startswith(f"{path}.") for place in places)
