"""The Python target: construct declarations, typed dataclasses, frames; and how to import them."""
