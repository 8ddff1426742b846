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
        found = judge.failure(data, 0, is_all=is_all)
        if found is not None:
            told += 1
            assert found == by_candidate(sender, data, is_all), (data.hex(" "), is_all)
    assert told > tried / 5


def test_a_start_of_two_flags_is_refused_at_its_first_byte(tmp_path: Path) -> None:
    path = tmp_path / "flags.yaml"
    path.write_text(
        "protocol: flags\nendpoints: {host: Host}\ntransparency: {preset: hdlc, covers: id..x}\n"
        "frame: {start: {literal: {hex: 7E 7E}}, id: {type: uint8, id: true}, payload: {}, "
        "x: {type: uint8, algorithm: sum-8, covers: id..payload}}\n"
        "messages: {m: {id: 1, from: host, fields: {a: uint8, b: uint8}}}\n",
        encoding="utf-8",
    )
    # A frame without its last two bytes, in front of a whole one.
    data = bytes.fromhex("7E 7E 01 05  7E 7E 01 05 06 0C")
    for engine in ("fast", "construct"):
        decoder = module_at(path).Decoder("host", engine=engine)
        lost, found = [*decoder.feed(data), *decoder.flush()]
        assert (lost.reason, lost.offset, lost.size) == ("stuffing", 0, 4)
        assert (found.offset, found.size) == (4, 6)


def test_the_first_byte_of_the_next_start_may_be_content(tmp_path: Path) -> None:
    path = tmp_path / "halves.yaml"
    path.write_text(
        "protocol: halves\nendpoints: {host: Host}\n"
        "transparency: {covers: id..x, escape: {byte: 0x7D, of: [0x55, 0x7D], transform: invert}}\n"
        "frame: {start: {literal: {hex: 41 55}}, id: {type: uint8, id: true}, payload: {}, "
        "x: {type: uint8, algorithm: sum-8, covers: id..payload}}\n"
        "messages: {m: {id: 1, from: host, fields: {a: uint8, b: uint8}}}\n",
        encoding="utf-8",
    )
    # A frame without its sum, in whose place the 41 of the next frame stands, and that frame.
    data = bytes.fromhex("41 55 01 05 06  41 55 01 05 06 0C")
    for engine in ("fast", "construct"):
        decoder = module_at(path).Decoder("host", engine=engine)
        lost, found = [*decoder.feed(data), *decoder.flush()]
        assert (lost.reason, lost.offset, lost.size) == ("checksum", 0, 5)
        assert (found.offset, found.size) == (5, 6)


def test_a_start_of_two_bytes_above_seven_bits_is_refused_at_its_first_byte(tmp_path: Path) -> None:
    path = tmp_path / "bits.yaml"
    path.write_text(
        "protocol: bits\nendpoints: {host: Host}\nbyte_bits: 7\n"
        "frame: {start: {literal: {hex: FF FF}}, id: {type: uint7, id: true}, payload: {}}\n"
        "messages: {m: {id: 1, from: host, fields: {a: uint7, b: uint7}}}\n",
        encoding="utf-8",
    )
    # A frame without its last byte, in front of a whole one.
    data = bytes.fromhex("FF FF 01 05  FF FF 01 05 06")
    for engine in ("fast", "construct"):
        decoder = module_at(path).Decoder("host", engine=engine)
        lost, found = [*decoder.feed(data), *decoder.flush()]
        assert (lost.reason, lost.offset, lost.size) == ("encoding", 0, 4)
        assert (found.offset, found.size) == (4, 5)


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
