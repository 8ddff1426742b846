"""Frames and streams whose bytes were worked out by hand, for every engine: YAML and its reader."""

from __future__ import annotations

from vectors.reading import ExpectedEvent, Stream, Vector, VectorFile, read_vectors, vector_files

__all__ = ["ExpectedEvent", "Stream", "Vector", "VectorFile", "read_vectors", "vector_files"]
