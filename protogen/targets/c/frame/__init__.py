"""The frame side: decoders, and what is put around payloads."""
