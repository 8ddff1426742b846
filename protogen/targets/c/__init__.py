"""The C target: codecs for firmware, in C99 without heap, recursion or unaligned access."""
