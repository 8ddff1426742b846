"""Tables of fields, and of what their values mean."""
