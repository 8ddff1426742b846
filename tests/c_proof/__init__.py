"""Proofs with Frama-C's EVA that generated C is safe for every input."""
