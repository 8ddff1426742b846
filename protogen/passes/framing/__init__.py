"""Frames: parts, checksums, transparency, and where a frame starts and ends."""
