"""Evolution of a protocol: two resolved models compared, and the effects on the wire.

`compare` finds the changes, `rules` says what each kind of change means, `witness` shows it with a
frame that one schema's codec makes and the other's reads.
"""
