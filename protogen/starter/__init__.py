"""The schema that `protogen init` writes: small, commented, and complete."""
