"""Frames of one sender: their parts, and how they are found, taken apart and put together."""
