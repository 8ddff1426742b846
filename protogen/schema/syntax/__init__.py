"""The syntax tree: what a schema file says, checked by shape."""
