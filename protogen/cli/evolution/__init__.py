"""Commands that compare two versions of a schema."""
