"""The canonical layout of a schema's text: what `protogen fmt` writes."""
