"""The text of a schema as a tree, each of whose nodes knows its place."""
