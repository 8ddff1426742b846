"""Messages: payloads, identities, examples."""
