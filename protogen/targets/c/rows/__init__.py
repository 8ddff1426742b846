"""C that fills rows of NumPy tables: a driver around the decoder, for a shared library."""
