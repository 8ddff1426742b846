"""Proofs with Frama-C's EVA and WP that generated C is safe for every input."""
