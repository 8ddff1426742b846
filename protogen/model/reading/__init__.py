"""Bytes and values as people read them: what `explain`, pages and comparisons show."""
