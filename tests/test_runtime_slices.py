"""What a judge says of the bytes between two starts is what a candidate says, byte by byte."""

from pathlib import Path
from random import Random

import pytest
from compiled import SCHEMAS, module_at, name_of, protocol_of
from corpus import DAMAGES, damaged, material_of

from protogen.runtime.framing.machine import Candidate, Cut, Failure
from protogen.runtime.framing.sender import SenderSpec
from protogen.runtime.framing.slices import SliceJudge, slice_judge
from protogen.runtime.framing.starts import starts_of


def judged() -> list[tuple[Path, str]]:
    """Endpoints whose damaged frames have a judge."""
    return [
        (path, sender.name)
        for path in SCHEMAS
        for sender in protocol_of(path).senders
        if slice_judge(module_at(path).PROTOCOL.sender(sender.name)) is not None
    ]


JUDGED = judged()


def by_candidate(sender: SenderSpec, wire: bytes, start: bytes) -> Cut | Failure | None:
    candidate = Candidate(sender)
    verdicts = map(candidate.push, wire + start)
    return next((verdict for verdict in verdicts if verdict is not None), None)


@pytest.mark.parametrize(("path", "name"), JUDGED, ids=name_of)
def test_a_judge_says_what_a_candidate_says(path: Path, name: str) -> None:
    sender = module_at(path).PROTOCOL.sender(name)
    judge, starts = slice_judge(sender), starts_of(sender.frame)
    assert isinstance(judge, SliceJudge)
    dice = Random(f"{path.stem} {name}")
    material = material_of(path, name)
    tried = told = 0
    while tried < 1500:
        data = damaged(dice.choice(list(DAMAGES)), dice.choice(material.frames), material, dice)
        ends = starts.find(data, 1, len(data) + 1)
        wire = data if ends < 0 else data[:ends]
        if starts.find(wire, 0, 1) != 0:
            continue
        tried += 1
        found = judge.failure(wire)
        if found is not None:
            told += 1
            start = dice.choice(material.frames)[: len(sender.layout.start) or 1]
            assert found == by_candidate(sender, wire, start), (wire.hex(" "), found)
    assert told > tried / 4


def test_the_documents_have_judges() -> None:
    names = {(path.stem, name) for path, name in JUDGED}
    assert {("rn1", "brain"), ("rflex", "flex"), ("matty", "esp"), ("matty", "pc")} <= names
