"""Commands that write generated files, and what one run of them does."""
