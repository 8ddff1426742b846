"""The resolved protocol: immutable, complete, and the only thing that a target reads."""
