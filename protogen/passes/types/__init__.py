"""Types: what fields are declared as, and how they lie in a payload."""
