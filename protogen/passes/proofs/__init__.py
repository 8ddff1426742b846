"""Proofs about the bytes on the wire: sizes, delimiters, undetected errors."""
