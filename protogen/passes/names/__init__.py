"""Names: no directives, unique, not reserved."""
