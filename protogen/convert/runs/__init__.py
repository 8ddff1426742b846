"""Whole conversions: interrupted ones that go on, and fleets of workers."""
