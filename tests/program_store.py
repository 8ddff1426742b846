"""Programs and libraries that tests compile, kept for other workers, which need the same ones."""

from __future__ import annotations

import os
import shutil
from collections.abc import Callable, Sequence
from hashlib import sha256
from pathlib import Path


def kept(
    command: Sequence[str | Path], sources: Sequence[Path], compile: Callable[[], Path]
) -> Path:
    """What is compiled, unless the same command compiled the same sources before.

    The command is without paths of the folder in which the sources are. They are all files that
    the compiler reads there, headers as well.
    """
    words = [str(word).encode() for word in command]
    texts = [text for path in sources for text in (path.name.encode(), path.read_bytes())]
    digest = sha256(b"\0".join([*words, b"", *texts])).hexdigest()
    place = Path(os.environ["XDG_CACHE_HOME"], "programs", digest)
    if not place.exists():
        place.parent.mkdir(parents=True, exist_ok=True)
        finished = place.with_suffix(f".{os.getpid()}")
        shutil.move(compile(), finished)
        finished.replace(place)  # At once, so that no other worker takes a half of it.
    return place
