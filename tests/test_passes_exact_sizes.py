"""Frame sizes of stuffed messages against every frame there is, encoded by a codec made here."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from functools import reduce
from itertools import product
from operator import xor
from random import Random

import pytest
from passes_support import HEAD, framing_of, message_framing, repository_protocol

from protogen.passes.proofs import correlation
from protogen.passes.proofs.correlation import Place, Sum, most_summed

Table = dict[int, bytes]
Checksum = Callable[[bytes], int]

RFLEX: Table = {0x1B: b"\x1b\x00", 0x7C: b"\x7c\x1b\x01"}
MATTY: Table = {0x55: b"\x56\xaa", 0x56: b"\x56\xa9"}


def stuffed(table: Table, data: Iterable[int]) -> bytes:
    return b"".join(table.get(byte, bytes((byte,))) for byte in data)


def exclusive_or(data: bytes) -> int:
    return reduce(xor, data, 0)


def negated_sum(data: bytes) -> int:
    return -sum(data) & 0xFF


def crc_8(data: bytes) -> int:
    """CRC-8/SMBUS, bit by bit."""
    register = 0
    for byte in data:
        register ^= byte
        for _ in range(8):
            register = (register << 1 ^ (0x07 if register & 0x80 else 0)) & 0xFF
    return register


def bounds(sizes: Iterable[int]) -> tuple[int, int]:
    found = set(sizes)
    return min(found), max(found)


def sizes_in(protocol: str, message: str) -> tuple[int, int]:
    """Sizes that the compiler gives a message of the repository."""
    for sender in repository_protocol(protocol).senders:
        for item in sender.framing.messages:
            if item.message == message:
                return item.least, item.greatest
    raise KeyError(message)


def rflex_sizes(class_id: int, subclass: int, payload: int) -> tuple[int, int]:
    """By hand: the number is free, the checksum is over the payload alone."""
    known = len(stuffed(RFLEX, [class_id, subclass, payload])) + 4
    sums = (
        len(stuffed(RFLEX, [*data, exclusive_or(bytes(data))]))
        for data in product([0x00, 0x01, 0x1B, 0x7C, 0x67], repeat=payload)
    )
    least, greatest = bounds(sums)
    return known + 1 + least, known + 3 + greatest


@pytest.mark.parametrize(
    ("message", "identity", "payload", "expected"),
    [
        ("request_system_status", (1, 0), 0, (9, 11)),
        ("motor_00", (2, 0), 1, (10, 16)),
        ("initialize_digital_io", (5, 1), 4, (13, 23)),
    ],
)
def test_rflex_against_all_that_tells_in_a_payload(
    message: str, identity: tuple[int, int], payload: int, expected: tuple[int, int]
) -> None:
    assert rflex_sizes(*identity, payload) == expected
    assert sizes_in("rflex", message) == expected


def test_the_greatest_frame_of_rflex() -> None:
    # 1B 02; class, number, subclass as 7C; the length 255; 255 times 7C and their exclusive or,
    # which is 7C as well; 1B 03
    assert exclusive_or(b"\x7c" * 255) == 0x7C
    for sender in repository_protocol("rflex").senders:
        assert sender.framing.greatest == 2 + 9 + 1 + 3 * 256 + 2 == 782


@pytest.mark.parametrize(("message", "command"), [("ack", "A"), ("nack", "N"), ("stop", "S")])
def test_matty_without_arguments_against_every_frame(message: str, command: str) -> None:
    frames = (bytes((2, counter, ord(command))) for counter in range(256))
    sizes = [1 + len(stuffed(MATTY, [*data, negated_sum(data)])) for data in frames]
    assert sizes_in("matty", message) == bounds(sizes)


def test_matty_with_an_argument_against_every_frame() -> None:
    contents = (
        bytes((3, counter, ord("M"), mode)) for counter, mode in product(range(256), [*range(256)])
    )
    sizes = [1 + len(stuffed(MATTY, [*data, negated_sum(data)])) for data in contents]
    assert sizes_in("matty", "mode") == bounds(sizes)


FRAME = """\
frame:
  sync: {literal: 0xC0}
  length: {type: uint8, counts: payload}
  counter: {type: uint8, counter: true}
  id: {type: uint8, id: true}
  payload: {}
  check: {type: uint8, algorithm: ALGORITHM, covers: length..payload}
transparency:
  covers: length..check
  escape: {byte: 0xDB, of: [0xC0, 0xDB], transform: {xor: 0x20}}
"""
TABLE: Table = {0xC0: b"\xdb\xe0", 0xDB: b"\xdb\xfb"}


def compiled_sizes(algorithm: str, identity: int, fields: str) -> tuple[int, int]:
    message = f"messages: {{gyro: {{id: {identity}, from: robot, fields: {{{fields}}}}}}}\n"
    text = HEAD + FRAME.replace("ALGORITHM", algorithm) + message
    item = message_framing(framing_of(text), "gyro")
    return item.least, item.greatest


@pytest.mark.parametrize(
    ("algorithm", "checksum"),
    [
        ("xor-8", exclusive_or),
        ("sum-8", lambda data: sum(data) & 0xFF),
        ("sum-8/negated", negated_sum),
        ("CRC-8/SMBUS", crc_8),
    ],
)
@pytest.mark.parametrize("identity", [0, 1, 0x1B, 0xC0, 0xDB])
def test_every_checksum_against_every_frame(
    algorithm: str, checksum: Checksum, identity: int
) -> None:
    alone = (bytes((0, counter, identity)) for counter in range(256))
    sizes = [1 + len(stuffed(TABLE, [*data, checksum(data)])) for data in alone]
    assert compiled_sizes(algorithm, identity, "") == bounds(sizes)


@pytest.mark.parametrize("algorithm", ["xor-8", "CRC-8/SMBUS"])
def test_constants_of_the_payload_are_known(algorithm: str) -> None:
    checksum = exclusive_or if algorithm == "xor-8" else crc_8
    contents = (bytes((3, counter, 1, 0xC0, 0x12, 0xDB)) for counter in range(256))
    sizes = [1 + len(stuffed(TABLE, [*data, checksum(data)])) for data in contents]
    fields = "a: {type: uint8, const: 0xC0}, b: {type: uint16, const: 0xDB12}"
    assert compiled_sizes(algorithm, 1, fields) == bounds(sizes)


def test_a_length_that_is_an_escape_is_longer_at_another_size_than_the_greatest() -> None:
    """Of 0 to 192 bytes, 192 is an escaped length (C0), and of 0 to 193 it is not."""
    for greatest in (192, 193):
        fields = f"data: {{type: bytes, size: {{fill: true, max: {greatest}}}}}"
        sizes = []
        for size in (191, 192, 193)[: greatest - 190]:
            # Ones among escapes: their sums are followed by hand for the last few bytes.
            contents = (
                bytes((size, 0xC0, 1, *([0xC0] * (size - free)), *tail))
                for free in (1, 2)
                for tail in product([0xC0, 0xDB, 0x00, 0x01, 0x1A, 0x1B], repeat=free)
            )
            sizes += [1 + len(stuffed(TABLE, [*data, exclusive_or(data)])) for data in contents]
        assert compiled_sizes("xor-8", 1, fields)[1] == max(sizes)


def test_a_wide_checksum_of_many_bytes_is_bounded() -> None:
    """Nothing is claimed to be exact there, but no frame may be longer."""
    frame = """\
frame:
  id: {type: uint8, id: true}
  payload: {}
  check: {type: uint32, algorithm: CRC-32/ISO-HDLC, covers: id..payload}
  end: {literal: 0xC0}
transparency: slip
"""
    message = "messages: {gyro: {id: 1, from: robot, fields: {a: {type: bytes, size: 300}}}}\n"
    item = message_framing(framing_of(HEAD + frame + message), "gyro")
    assert (item.least, item.greatest) == (1 + 300 + 4 + 1, 1 + 600 + 8 + 1)


@pytest.mark.parametrize("seed", range(20))
@pytest.mark.parametrize(
    ("step", "steps"),
    [
        (xor, correlation.exclusive_or),
        (lambda one, other: (one + other) & 0xFF, correlation.added),
    ],
    ids=["xor", "sum"],
)
def test_sums_are_followed_as_if_all_contents_were_tried(
    step: Callable[[int, int], int], steps: Sum, seed: int
) -> None:
    dice = Random(seed)
    prices = [dice.choice([1, 1, 1, 2, 3]) for _ in range(256)]
    kinds = [
        Place.of(frozenset(dice.sample(range(256), dice.randint(1, 3))), prices.__getitem__)
        for _ in range(2)
    ]
    places = [kind for kind in kinds for _ in range(dice.randint(1, 5))]
    values = [[value for own in place.options.values() for value in own] for place in places]
    register = dice.randrange(256)
    worths = [dice.choice([1, 2, 4]) for _ in range(256)]
    best = max(
        sum(prices[value] for value in content) + worths[reduce(step, content, register)]
        for content in product(*values)
    )
    assert most_summed(places, steps, worths, register) == best
