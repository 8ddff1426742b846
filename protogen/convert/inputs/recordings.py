"""Recordings as captures of what one endpoint sent: see `protogen/recording/format.py`."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator

from protogen.convert.inputs.text_logs import Complain
from protogen.recording import RecordKind, records


def recorded_pieces(
    pieces: Iterable[bytes], sender: str, senders: Collection[str], complain: Complain
) -> Iterator[tuple[bytes, int]]:
    """The bytes of each record that is not another sender's, with its time in nanoseconds.

    What is no record ends the capture and is complained of.
    """
    for record in records(pieces, complain):
        if record.kind is not RecordKind.BYTES:
            continue
        if record.source not in senders or record.source == sender:
            yield record.data, record.when
