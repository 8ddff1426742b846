"""Definitions of the Swift Navigation Binary Protocol, the YAML files of libsbp, to schemas."""
