"""nanopb's C sources, fetched by npm."""

from __future__ import annotations

import re
import subprocess
import sys
import tarfile
from functools import cache
from pathlib import Path

from c_costs.protocols import CACHE

NANOPB = "grpc@1.15.0"
"""An npm package that carries nanopb's C sources; nanopb's own on PyPI has none."""


@cache
def nanopb() -> Path | None:
    """The folder of nanopb's C sources; None where they can't be fetched."""
    folder = CACHE / "nanopb"
    if not (folder / "pb.h").exists():
        folder.mkdir(parents=True, exist_ok=True)
        command = ["npm", "pack", "--silent", NANOPB, "--pack-destination", str(folder)]
        try:
            subprocess.run(command, capture_output=True, check=True)
        except (OSError, subprocess.CalledProcessError):
            print(f"nanopb is left out: {' '.join(command)} failed", file=sys.stderr)
            return None
        _unpack_nanopb(next(folder.glob("grpc-*.tgz")), folder)
    return folder


def _unpack_nanopb(archive: Path, folder: Path) -> None:
    with tarfile.open(archive) as members:
        for member in sorted(members, key=lambda item: item.name):
            place = re.fullmatch(r".*/third_party/nanopb/(pb\w*\.[ch]|LICENSE.txt)", member.name)
            data = members.extractfile(member) if place else None
            if place and data:
                (folder / place[1]).write_bytes(data.read())
    archive.unlink()


def nanopb_version() -> str:
    """As its header has it."""
    folder = nanopb()
    text = (folder / "pb.h").read_text(encoding="utf-8") if folder else ""
    found = re.search(r"NANOPB_VERSION nanopb-(\S+)", text)
    return found[1] if found else "missing"
