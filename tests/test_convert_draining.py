"""Files that go to the disk while they are written hold what was written."""

from __future__ import annotations

import errno
import os
from contextlib import closing
from pathlib import Path
from random import Random

import pytest

from protogen.convert.writers import drained_file as draining
from protogen.convert.writers.drained_file import DrainedFile


def test_all_that_was_written_is_there(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(draining, "_STRETCH", 1000)
    dice = Random(1)
    pieces = [dice.randbytes(dice.randrange(700)) for _ in range(100)]
    with closing(DrainedFile(tmp_path / "file")) as file:
        file.write(pieces[0])
        file.writelines(pieces[1:])
    assert (tmp_path / "file").read_bytes() == b"".join(pieces)


@pytest.mark.skipif(not hasattr(os, "posix_fadvise"), reason="the system takes no advice")
@pytest.mark.parametrize("size", [500, 1000, 7000], ids=["half", "one", "seven"])
def test_every_stretch_is_told_of_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, size: int
) -> None:
    told: list[tuple[int, int]] = []

    def note(descriptor: int, start: int, size: int, advice: int) -> None:
        assert advice == os.POSIX_FADV_DONTNEED
        told.append((start, start + size))

    monkeypatch.setattr(draining, "_STRETCH", 1000)
    monkeypatch.setattr(os, "posix_fadvise", note)
    with closing(DrainedFile(tmp_path / "file")) as file:
        file.writelines(bytes(size) for _ in range(20))
    ends = [end for _, end in told]
    assert ends == list(range(max(size, 1000), 20 * size + 1, max(size, 1000)))
    for place in range(500, ends[-4] + 1, 1000):
        assert sum(start <= place < end for start, end in told) == 4


@pytest.mark.skipif(not hasattr(os, "posix_fadvise"), reason="the system takes no advice")
def test_files_are_written_where_advice_fails(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(*_: object) -> None:
        raise OSError(errno.ENOSYS, "Function not implemented")

    monkeypatch.setattr(os, "posix_fadvise", refuse)
    monkeypatch.setattr(draining, "_STRETCH", 10)
    with closing(DrainedFile(tmp_path / "file")) as file:
        file.write(bytes(100))
    assert (tmp_path / "file").read_bytes() == bytes(100)


def test_files_are_written_where_no_advice_is_taken(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delattr(os, "posix_fadvise", raising=False)
    monkeypatch.setattr(draining, "_STRETCH", 10)
    with closing(DrainedFile(tmp_path / "file")) as file:
        file.write(bytes(100))
    assert (tmp_path / "file").read_bytes() == bytes(100)
