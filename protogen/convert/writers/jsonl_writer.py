"""JSON lines: those of `protogen decode --format jsonl`, so that `protogen encode` takes them."""

from __future__ import annotations

from protogen.convert.columns.batches import Batch
from protogen.convert.writers.drained_file import DrainedFile
from protogen.convert.writers.pending_files import Pending


class JsonlWriter:
    """Writes one file."""

    def __init__(self, name: str, pending: Pending) -> None:
        self._file = DrainedFile(pending.path(f"{name}.jsonl"))

    def write(self, batch: Batch) -> None:
        """Write the events of a batch."""
        self._file.writelines(batch.lines())

    def close(self) -> None:
        """Write what is left."""
        self._file.close()
