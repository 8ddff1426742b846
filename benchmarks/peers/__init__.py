"""The contenders of `bench_python.py`: everything that decodes and encodes the same messages."""
