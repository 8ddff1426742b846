"""Output of the targets, used at once: Python imported from memory, C that fills rows."""
