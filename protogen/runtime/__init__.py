"""The library of generated Python. It depends on construct and the standard library, nothing else.

`api` has every name that a generated module or its user needs. It is not imported here, because
the compiler uses parts of this package and should not wait for construct.
"""
