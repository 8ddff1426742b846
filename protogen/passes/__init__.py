"""Syntax tree -> protocol model: one question a pass, in a visible order."""
