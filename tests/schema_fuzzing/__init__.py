"""Random valid schemas, values for their messages, and damage to both."""

from __future__ import annotations

from schema_fuzzing.schemas import Schema, schemas

__all__ = ["Schema", "schemas"]
