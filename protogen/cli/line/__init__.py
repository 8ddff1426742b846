"""Commands that work on a live line."""
