"""libFuzzer on the decoders of generated C."""
