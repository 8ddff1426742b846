"""The line: a port is opened by its address, read with times, and written."""
