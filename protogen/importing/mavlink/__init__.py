"""Definitions of MAVLink, the XML files of its dialects, to schemas."""
