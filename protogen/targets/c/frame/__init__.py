"""The frame side: what is put around payloads, and the fragments that decoders share with it."""
