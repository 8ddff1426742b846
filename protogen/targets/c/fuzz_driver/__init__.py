"""Printer of a C program that calls generated code, for the fuzzer and the tests of machines."""
