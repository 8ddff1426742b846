"""A user's project: its `protogen.toml`, what was generated before, and marked blocks.

`find.py` and `read.py` find and read the file, `settings.py` says what may stand in it; the command
line goes over it in `protogen/cli/generation/plan.py`. `record.py` remembers a run, so that the
next one can see that nothing changed. `blocks.py` fills marked blocks of hand-written Markdown,
`watch.py` notices changes.
"""
