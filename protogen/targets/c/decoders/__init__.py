"""Decoders as C prints them: what they keep, in which style, and what they do with a byte."""
