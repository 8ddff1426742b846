"""Commands about bytes: decoding, encoding, explaining and converting them."""
