"""Many frames of a capture at once: without events and without message objects.

`cutting.py` finds frames, `contents.py` takes their stuffing off, `checking.py` looks at lengths
and checksums, `records.py` turns payloads into rows. Each takes only what is plainly in order;
`cutter.py` hands such runs to the decoder, which decides everything else itself.
"""
