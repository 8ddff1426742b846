"""Inputs of fuzzers that are kept: a text for each schema, with an input in each line."""

from __future__ import annotations

from hashlib import sha1
from pathlib import Path

KEPT = Path(__file__).resolve().parent / "corpus"


def text_of(path: Path) -> Path:
    """The text of a schema."""
    return KEPT / f"{path.stem}.txt"


def unpack(path: Path, folder: Path) -> int:
    """Put the inputs of a schema into a folder, as libFuzzer wants them; returns how many."""
    text = text_of(path)
    lines = text.read_text(encoding="ascii").splitlines() if text.exists() else []
    for line in lines:
        data = bytes.fromhex(line)
        (folder / sha1(data, usedforsecurity=False).hexdigest()).write_bytes(data)
    return len(lines)


def pack(folder: Path, path: Path) -> None:
    """Keep the inputs of a folder for a schema, the shortest first."""
    inputs = sorted({file.read_bytes() for file in folder.iterdir()}, key=lambda b: (len(b), b))
    KEPT.mkdir(exist_ok=True)
    text_of(path).write_text("".join(f"{data.hex()}\n" for data in inputs), encoding="ascii")
