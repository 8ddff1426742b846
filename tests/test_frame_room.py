"""Room for a frame: as much as its parts can need, and no less than its greatest frame has.

The greatest frame comes of another analysis, which follows every value of every field.
"""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from compiled import SCHEMAS, name_of, protocol_of

from protogen.model.frame_room import room
from protogen.targets.c.emit import emit
from protogen.targets.c.options import COptions

_SIZES = re.compile(r"#define (\w+)_FRAME_MAX (\d+)U\n#define \1_FRAME_ROOM (\d+)U")


def sizes_in(path: Path) -> dict[str, tuple[int, int]]:
    """Greatest frame and room for it, by message."""
    headers = (file.text for file in emit([protocol_of(path)], COptions()))
    return {
        name: (int(most), int(asked))
        for text in headers
        for name, most, asked in _SIZES.findall(text)
    }


@pytest.mark.parametrize("path", SCHEMAS, ids=name_of)
def test_a_buffer_suffices_for_the_greatest_frame(path: Path) -> None:
    for name, (most, asked) in sizes_in(path).items():
        assert most <= asked, name


@pytest.mark.parametrize("name", ["uherobot", "rn1", "dagny"])
def test_digits_and_plain_bytes_take_what_their_frame_has(name: str) -> None:
    """A start and an end are one byte each; in between each byte is two digits, or itself."""
    [path] = [path for path in SCHEMAS if path.stem == name]
    sizes = sizes_in(path)
    assert sizes
    assert all(most == asked for most, asked in sizes.values())


@pytest.mark.parametrize(("sender", "needed"), [("linux", 13), ("flex", 15)])
def test_what_is_never_replaced_takes_one_byte(sender: str, needed: int) -> None:
    """A frame of rflex without a payload, in which 1b becomes two bytes and 7c three.

    1b 02 and 1b 03 around it stay as they are: 4 bytes. No class and no subclass is 1b or 7c: 2
    bytes. Number and checksum can be 7c: 6 bytes. Linux sends payloads of up to 14 bytes, so that
    its length takes 1 byte; that of flex, up to 254, can be 7c: 3 bytes.
    """
    [path] = [path for path in SCHEMAS if path.stem == "rflex"]
    assert room(protocol_of(path).sender(sender).plan, 0) == needed
