"""The live view of a line, in a terminal; needs `pip install 'protogen-serial[monitor]'`."""
