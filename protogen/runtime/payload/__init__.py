"""Payloads: messages, their fields, and what the values of fields mean."""
