"""Generated C, as a user gets it, in a folder without anything else."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from protogen.model.protocol import Protocol
from protogen.targets.c.emit import emit
from protogen.targets.c.options import COptions


@dataclass(frozen=True)
class Generated:
    """The C of one protocol."""

    protocol: Protocol
    folder: Path
    header: Path
    source: Path | None
    """None where the header holds all."""
    stubs: Path | None
    """Empty handlers, where they were asked for."""

    @property
    def files(self) -> tuple[Path, ...]:
        """All that is C."""
        return (self.header,) if self.source is None else (self.header, self.source)


def generate(protocol: Protocol, folder: Path, options: COptions = COptions()) -> Generated:  # noqa: B008
    """Write the C of a protocol, wherever the target would put it, straight into the folder."""
    for file in emit([protocol], options):
        if file.path.suffix in (".h", ".c"):
            (folder / file.path.name).write_text(file.text, encoding="utf-8")
    source, stubs = folder / f"{protocol.name}.c", folder / f"{protocol.name}_stubs.c"
    return Generated(
        protocol,
        folder,
        folder / f"{protocol.name}.h",
        source if source.exists() else None,
        stubs if stubs.exists() else None,
    )
