"""Recordings: the bytes of a line as they came, with times, from one end or from several."""

from protogen.recording.format import Record, RecordKind
from protogen.recording.reader import records
from protogen.recording.recorder import Recorder

__all__ = ["Record", "RecordKind", "Recorder", "records"]
