"""Names: usable in every target, unique, not reserved."""
