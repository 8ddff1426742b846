"""The header for C++ over the generated C."""
