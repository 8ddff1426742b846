"""From the text of a schema to what was written: YAML with spans, `extends`, syntax."""
