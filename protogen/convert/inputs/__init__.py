"""Captures as bytes of the line, whatever they are written in."""
