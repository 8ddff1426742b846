"""Dialects: what `extends` merges, renames, removes and places."""
