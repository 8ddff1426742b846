"""The version of protogen."""

VERSION = "0.1.0"
