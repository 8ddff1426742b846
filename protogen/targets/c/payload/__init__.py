"""Payload side of the C target: structs, and functions that print the steps of payload plans."""
