"""What a judge says of a damaged frame is what a candidate says, byte by byte."""

from pathlib import Path
from random import Random

import pytest
from compiled import SCHEMAS, module_at, name_of, protocol_of
from corpus import DAMAGES, damaged, material_of

from protogen.runtime.framing.damage import Judge, judge_of
from protogen.runtime.framing.machine import Candidate, Cut, Failure
from protogen.runtime.framing.sender import SenderSpec
from protogen.runtime.framing.starts import starts_of


def judged() -> list[tuple[Path, str]]:
    """Endpoints whose damaged frames have a judge."""
    return [
        (path, sender.name)
        for path in SCHEMAS
        for sender in protocol_of(path).senders
        if judge_of(module_at(path).PROTOCOL.sender(sender.name)) is not None
    ]


JUDGED = judged()


def by_candidate(sender: SenderSpec, data: bytes, is_all: bool) -> Cut | Failure | None:
    candidate = Candidate(sender)
    verdicts = map(candidate.push, data)
    found = next((verdict for verdict in verdicts if verdict is not None), None)
    return candidate.flush() if found is None and is_all else found


@pytest.mark.parametrize(("path", "name"), JUDGED, ids=name_of)
def test_a_judge_says_what_a_candidate_says(path: Path, name: str) -> None:
    sender = module_at(path).PROTOCOL.sender(name)
    judge, starts = judge_of(sender), starts_of(sender.frame)
    assert isinstance(judge, Judge)
    dice = Random(f"{path.stem} {name}")
    material = material_of(path, name)
    tried = told = 0
    while tried < 1500:
        data = damaged(dice.choice(list(DAMAGES)), dice.choice(material.frames), material, dice)
        if starts.find(data, 0, 1) != 0:
            continue
        data += dice.choice(material.frames)
        tried += 1
        is_all = dice.random() < 0.5
        found = judge.verdict(data, 0, starts.find(data, 1, len(data) + 1), is_all=is_all)
        if found is not None:
            told += 1
            due = by_candidate(sender, data, is_all)
            assert found == (due.size if isinstance(due, Cut) else due), (data.hex(" "), is_all)
    # What damages those texts, a candidate has to judge in most cases.
    assert told > tried / (20 if path.stem == "text_parts" else 5)


FRAME = (
    "id: {type: uint8, id: true}, payload: {}, "
    "x: {type: uint8, algorithm: sum-8, covers: id..payload}"
)
TWO_BYTES = {
    # Flags are refused in a stuffed region. A frame without its last two bytes, and a whole one.
    "flags": (
        "transparency: {preset: hdlc, covers: id..x}\n"
        f"frame: {{start: {{literal: {{hex: 7E 7E}}}}, {FRAME}}}\n",
        "uint8",
        ("7E 7E 01 05", "7E 7E 01 05 06 0C"),
        ("stuffing", 4),
    ),
    # 41 may be content. A frame without its sum, in whose place the next frame's 41 stands.
    "halves": (
        "transparency: {covers: id..x, escape: {byte: 0x7D, of: [0x55, 0x7D], transform: invert}}\n"
        f"frame: {{start: {{literal: {{hex: 41 55}}}}, {FRAME}}}\n",
        "uint8",
        ("41 55 01 05 06", "41 55 01 05 06 0C"),
        ("checksum", 5),
    ),
    # FF is none of seven bits. A frame without its last byte, in front of a whole one.
    "bits": (
        "byte_bits: 7\n"
        "frame: {start: {literal: {hex: FF FF}}, id: {type: uint7, id: true}, payload: {}}\n",
        "uint7",
        ("FF FF 01 05", "FF FF 01 05 06"),
        ("encoding", 4),
    ),
}


@pytest.mark.parametrize("name", TWO_BYTES)
def test_the_first_byte_of_a_start_of_two_may_end_what_is_in_front(
    name: str, tmp_path: Path
) -> None:
    framing, type_, (damaged_frame, frame), (reason, size) = TWO_BYTES[name]
    path = tmp_path / f"{name}.yaml"
    path.write_text(
        f"protocol: {name}\nendpoints: {{host: Host}}\n{framing}"
        f"messages: {{m: {{id: 1, from: host, fields: {{a: {type_}, b: {type_}}}}}}}\n",
        encoding="utf-8",
    )
    whole = bytes.fromhex(frame)
    data = bytes.fromhex(damaged_frame) + whole
    for engine in ("fast", "construct"):
        decoder = module_at(path).Decoder("host", engine=engine)
        lost, found = [*decoder.feed(data), *decoder.flush()]
        assert (lost.reason, lost.offset, lost.size) == (reason, 0, size)
        assert (found.offset, found.size) == (size, len(whole))


def test_the_documents_have_judges() -> None:
    names = {(path.stem, name) for path, name in JUDGED}
    assert {("rn1", "brain"), ("rflex", "flex"), ("matty", "esp"), ("matty", "pc")} <= names


def test_nested_false_starts_are_not_taken_byte_by_byte(monkeypatch: pytest.MonkeyPatch) -> None:
    """Each announces 64 bytes, in which others start: candidates would take 14 times the stream."""
    (path,) = (path for path in SCHEMAS if path.stem == "sync_length_crc")
    stream = bytes.fromhex("B5 62 42 40 00") * 400
    taken = 0
    push = Candidate.push

    def counted(candidate: Candidate, byte: int) -> Cut | Failure | None:
        nonlocal taken
        taken += 1
        return push(candidate, byte)

    expected = module_at(path).Decoder("station", engine="construct")
    events = expected.feed(stream) + expected.flush()
    monkeypatch.setattr(Candidate, "push", counted)
    decoder = module_at(path).Decoder("station")
    assert decoder.feed(stream) + decoder.flush() == events
    assert taken < len(stream) / 4
