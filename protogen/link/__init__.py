"""The live line: ports, recordings, and links that speak a protocol."""
