"""Definitions of other tools to schemas: what they say as data, printed as `protogen fmt` does.

What a definition says and a schema can't is kept as a remark, by name and with the reason.
"""
