"""What the targets print, used at once: Python imported from memory, C that fills rows."""
