"""How things are written in C, whoever prints it: words, numbers and expressions."""
