"""Random and boundary round trips of every message through every engine."""
