"""The Markdown target: a page to read for each protocol, an index, and a page of counts.

`emit` is the entry. What a page shows is decided in Python, one question per module, as plain
values whose texts are Markdown already; the templates only print them.
"""
